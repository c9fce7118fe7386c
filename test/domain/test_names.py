"""Names that people can say, and the one that they mean by what they type."""

from __future__ import annotations

import re
import unicodedata

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from al_questioner.domain import InputError
from al_questioner.domain.names import check_names, joined, meant, near, parted, quoted, unsayable
from al_questioner.domain.reserved_words import RESERVED
from al_questioner.domain.spelling import loosely
from al_questioner.questioning.plain_answers import OUTCOMES
from al_questioner.terminal.commands import WISHES
from al_questioner.terminal.keypad import COMMANDS

NUMBER, COMMA, BLANK = 'a number means an object', 'a comma parts names', 'begins or ends with a blank'
NO_LETTER = 'it holds no letter'


@pytest.mark.parametrize(
    ('name', 'reason'),
    [
        *((name, 'says that a thing belongs to no symbol') for name in ('none', 'None', 'ＮＯＮＥ', 'none.')),
        ('SKİP', 'skips a question'),
        *((name, 'says that the teacher does not know') for name in ('Unknown', '？', '؟', "don't know")),
        ('undo', 'takes an answer back'),
        ('quit', 'ends the conversation'),
        ('help', 'asks for help'),
        ('features', 'asks which properties matter'),
        ('nothing', 'stands for nothing'),
        ('S', 'is the key of "skip"'),
        ('"cup"', 'quotes mark'),
        *((name, NUMBER) for name in ('7', '#7', 'object 7', '٧', '½', '-3', '1.5', '1e5', '1 000', '９', '三')),
        *((name, NUMBER) for name in ('Ⅶ', '⑴', '㈦', '⒎', '٣٫٥', '1/2', '−1', '–1', '1’000', '7%', '(7)', '1:30')),
        *((name, NUMBER) for name in ('0x1F', '0b1', '0o7', 'inf', '-Infinity', '.nan', '1e-3')),
        *((name, NUMBER) for name in ('no. 7', 'No.7', '№ 7', 'number 7', 'Object #7', 'obj_7')),
        *((name, NO_LETTER) for name in ('.', '...', '-', '_', '€', '&', '( )', '→')),
        *((name, "'?' says that the teacher does not know") for name in ('??', '¿?', '?!', '…？')),
        *((name, "'none' says") for name in ('(none)', '[None]', '«none»', '“none”', '*none*', '<none>')),
        *((name, "'none' says") for name in ('none?', '`none`')),
        *((name, "'skip' skips a question") for name in ('skip?', '~skip~', 'skip…', 'ѕкір')),
        *((name, 'that a thing belongs to no symbol') for name in ('no', 'NULL', 'nil', 'n/a', 'nоne', 'ΝΟΝΕ')),
        *((name, 'does not know') for name in ('don’t know', 'dont know', 'not sure', 'I don´t know')),
        *((name, 'what people say to a program') for name in ('yes', 'True', 'false', 'done', 'Next')),
        *((name, "means 'none'") for name in ('Keine', '無', 'нет', 'niks', 'brak', 'hiçbiri', 'HİÇBİRİ', 'hicbiri')),
        *((name, "means 'none'") for name in ('không', 'tidak ada', 'κανένα', 'ΚΑΝΕΝΑ', 'כלום', 'कोई नहीं')),
        *((name, "means 'unknown'") for name in ('weiß nicht', 'WEISS NICHT', 'άγνωστο', 'غير معروف', 'अज्ञात')),
        *((name, "means 'unknown'") for name in ('bilinmiyor', 'לא ידוע', 'δεν ξέρω', 'non lo so', 'نمی‌دانم')),
        *((name, "means 'skip'") for name in ('hoppa över', 'hoppa over', 'atla', 'ohita', 'bỏ qua', 'דלג', 'пропуск')),
        *(('ei mitään', "means 'none'"), ('no se', "means 'unknown'"), ('desconocido', "means 'unknown'")),
        ('スキップ', "means 'skip'"),
        *((name, COMMA) for name in ('cup,plate', 'cup，plate', 'a、b')),
        *((name, BLANK) for name in (' cup', 'cup ', '\u00a0cup', 'cup\u3000')),
        *((name, 'it is empty') for name in ('', '  ')),
        *((name, 'the invisible character U+200C') for name in ('c\u200cup', '\u200cنان')),
        ('cu\u200bp', 'the invisible character U+200B'),
        ('cup\n', 'the invisible character U+000A'),
        ('cup\u00ad', 'the invisible character U+00AD'),
        ('\u3164', 'the invisible character U+3164'),
        ('cup\x1b[2J', 'the invisible character U+001B'),
        ('cup\ud800', 'the invisible character U+D800'),
        (unicodedata.normalize('NFD', 'Früchte'), 'decomposed'),
        ('ｃｕｐ', "write 'cup'"),
        ('cup\u00a0plate', "write 'cup plate'"),
        ('{cup', 'is read as a JSON document'),
    ],
)
def test_a_name_that_people_cannot_say_is_refused_with_the_reason(name: str, reason: str) -> None:
    """The reason is a second meaning, a comma, a blank, or a character that people cannot see or type."""
    with pytest.raises(InputError, match='cannot be a symbol') as caught:
        check_names(['plate', name], 'symbol')
    assert quoted(name) in str(caught.value)
    assert reason in str(caught.value)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize(
    ('one', 'other'),
    [
        *(('Cup', 'cup'), ('straße', 'STRASSE'), ('ΣΟΦΟΣ', 'σοφος'), ('ÉTÉ', 'été'), ('KIRMIZI', 'kırmızı')),
        *(('main dish', 'main_dish'), ('fig', 'ﬁg'), ('x²', 'x2'), ('cup.', 'cup'), ('cup', '(cup)!')),
        *(('cup-x', 'cup x'), ('cup–x', 'cup-x'), ('o’clock', "o'clock"), ('☕', '☕\ufe0f')),
        *(('ёлка', 'елка'), ('сup', 'cup'), ('СОР', 'cop.'), ('Α', 'a'), ('かっぷ', 'カップ')),
        *(('کیک', 'كيك'), ('كـأس', 'كأس'), ('كَأْس', 'كاس'), ('כּוֹס', 'כוס'), ('می\u200cخواهم', 'میخواهم')),
    ],
)
def test_two_names_that_sound_the_same_are_refused(one: str, other: str) -> None:
    """A teacher who says one of them must not teach the other."""
    with pytest.raises(InputError, match=re.escape(f'{other!r} cannot be a symbol beside {one!r}')):
        check_names([one, 'plate', other], 'symbol')


def test_ordinary_names_of_many_languages_are_fine() -> None:
    """Otherwise people could not use their own words."""
    check_names(
        [
            *('main_dish', 'Früchte', 'straße', 'カップ', '杯子', 'чашка', 'कप', 'น้ำ', 'x²', '7up', 'v1.2', 'nonesuch'),
            *('bär', 'bar', 'कुप', 'C', 'C++', 'C#', 'Na', 'nose', 'nić', 'het', 'VII', '2x4', 'T-shirt', 'Ei', 'cap'),
            *("d'eau", '🍎', '🍐'),
            *('a b', 'v1.2 b', 'v12 b', 'no.2 pencil', 'nonstick pan'),
            *('می\u200cخواهم', 'ශ්\u200dරී', 'നന്\u200d', '☕\ufe0f', '👨\u200d👩\u200d👧', '❤\ufe0f\u200d🔥'),
        ],
        'symbol',
    )


def test_what_only_keys_mean_is_free_where_no_key_says_a_name() -> None:
    """Otherwise a camera's groups h, s and v could not be relevant."""
    check_names(['h', 's', 'v'], 'feature group', has_key=False)
    with pytest.raises(InputError, match="'skip' cannot be a feature group"):
        check_names(['skip'], 'feature group', has_key=False)


def test_every_word_that_is_a_command_anywhere_is_reserved() -> None:
    """Otherwise a symbol of that name would be taken for the command, or the command for the symbol."""
    for word in (*OUTCOMES, *WISHES, *COMMANDS):
        assert loosely(word) in RESERVED, word


@pytest.mark.parametrize(
    ('word', 'names', 'found'),
    [
        ('cup', ['Cup', 'cup'], ['cup']),
        ('CUP', ['Cup', 'cup'], ['Cup', 'cup']),
        (' cup\n', ['cup', 'plate'], ['cup']),
        ('cup', [' cup ', 'plate'], [' cup ']),
        (unicodedata.normalize('NFD', 'Früchte'), ['Früchte', 'früchte'], ['Früchte']),
        (unicodedata.normalize('NFC', 'Früchte'), [unicodedata.normalize('NFD', 'Früchte')], ['Fru\u0308chte']),
        ('FRÜCHTE', ['Früchte'], ['Früchte']),
        ('main dish', ['main_dish'], ['main_dish']),
        ('KIRMIZI', ['kırmızı'], ['kırmızı']),
        ('елка', ['ёлка', 'елка'], ['елка']),
        ('елка', ['ёлка', 'cup'], ['ёлка']),
        ('☕', ['☕\ufe0f'], ['☕\ufe0f']),
        ('ｃｕｐ\u200b', ['cup'], ['cup']),
        ('STRASSE', ['straße'], ['straße']),
        ('', ['', 'cup'], []),
        ('plates', ['plate'], []),
        ('a' * 2000, ['A' * 2000], []),
        ('a' * 2000, ['a' * 2000], ['a' * 2000]),
    ],
)
def test_a_word_means_what_it_is_exactly_before_what_it_is_like(word: str, names: list[str], found: list[str]) -> None:
    """Otherwise the wrong one of two names would be learnt, or the right one refused."""
    assert meant(word, names) == found


def test_a_near_miss_has_a_suggestion() -> None:
    """Otherwise people would not see what is wrong with their word."""
    assert near('screwdrver', ['skip', 'screwdriver']) == 'screwdriver'
    assert near('Srkewdriver', ['skip', 'screwdriver']) == 'screwdriver'
    assert near('cpu', ['plate', 'cup']) == 'cup'
    assert near('fork', ['plate', 'cup']) is None


@pytest.mark.parametrize(
    ('word', 'found'),
    [
        ('fruit', None),
        ('hello', None),
        ('hepl', 'help'),
        ('quti', 'quit'),
        ('qit', 'quit'),
        ('skap', 'snap'),
        ('skp', 'skip'),
        ('unkown', 'unknown'),
    ],
)
def test_a_command_is_suggested_only_if_it_is_much_nearer(word: str, found: str | None) -> None:
    """The name of something else is not answered with the advice to quit."""
    assert near(word, ['plate', 'cutlery', 'snap'], ['quit', 'help', 'skip', 'unknown']) == found


def test_every_reserved_word_is_refused_however_it_is_marked() -> None:
    """The table has ß and accents, which a comparison must fold on both sides."""
    for word in RESERVED:
        for form in (word, word.upper(), word.title(), f'{word}.', f'{word}?', f'({word})', f'“{word}”'):
            assert unsayable(form), form


@given(st.lists(st.text(min_size=1).map(str.strip).filter(bool), min_size=1), st.booleans())
def test_joined_names_can_be_parted_again(names: list[str], quotes: bool) -> None:
    """Otherwise a name with a comma would become two."""
    sayable = [name for name in names if quotes or '"' not in name]
    assert parted(joined(sayable, quotes)) == sayable


@given(st.text())
def test_whatever_is_called_so_can_be_judged(name: str) -> None:
    """Otherwise a strange name would end a node."""
    assert isinstance(unsayable(name), str)
    assert loosely(loosely(name)) == loosely(name)
    assert near(name, ['cup']) in ('cup', None)


@given(st.text(min_size=1))
@example('A´')
def test_a_name_that_is_not_refused_is_understood(name: str) -> None:
    """Otherwise a symbol could not be said."""
    if not unsayable(name):
        for form in ('NFC', 'NFD', 'NFKC', 'NFKD'):
            assert meant(f' {unicodedata.normalize(form, name)}\n', [name, 'quite another']) == [name]
