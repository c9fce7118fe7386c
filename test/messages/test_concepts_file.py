"""Concepts files: every bit comes back, and one that cannot be used is refused in one line."""

import json

import numpy as np
import pytest

from al_questioner.domain import (
    Classifiers,
    Hearsay,
    InputError,
    Knowledge,
    Lesson,
    Origin,
    QueryKind,
    SeenView,
    Statistics,
    TeacherCounts,
    ViewJudgement,
    ViewLabel,
)
from al_questioner.messages.concepts_file import concepts_of_text, read_concepts, write_concepts
from al_questioner.messages.concepts_text import concepts_text, fingerprint
from al_questioner.messages.knowledge_members import exact, readable, time_of, time_text
from al_questioner.questioning.review import taught_learner

WORLD = {'task': 't', 'seed': 1, 'sample': 1, 'dataset': None}
FEATURES = ('colour_red', 'colour_green', 'size_height')


def knowledge(**changes):
    """Return what two turns taught, with every kind of content."""
    seen = tuple(SeenView(n, 10 + n, tuple(np.float32([n / 3, -0.0, 1e-30]).tolist())) for n in (1, 2))
    lessons = (
        Lesson('day 1', 1, 1_764_347_912_123_456_789, seen, QueryKind.LABEL, 'anna', labels=(ViewLabel(1, 'snack'),)),
        Lesson('day 1', 2, None, (), QueryKind.RELEVANCE, 'bob', (ViewJudgement(1, True), ViewJudgement(2, False))),
        Lesson('day 1', 3, labels=(ViewLabel(2, 'none'),), hearsay=(Hearsay(1, 'fruit', 'eve'),)),
        Lesson('day 1', 4, groups=('colour',), unnameable=(2,), kind=QueryKind.FEATURE_SUBSET),
    )
    told = {
        'symbols': ('snack', 'fruit'),
        'feature_names': FEATURES,
        'classifiers': Classifiers(),
        'length_scale': 2.5,
        'lessons': lessons,
        'origins': (
            Origin(
                'day 1',
                ('snack', 'fruit'),
                'dt_task',
                WORLD,
                '0.1',
                {'anna': TeacherCounts(3, 1), 'bob': TeacherCounts()},
            ),
        ),
        'reliabilities': {'anna': 0.9},
        'statistics': Statistics(2, (0.1, 0.2, 1 / 3), (1.0, 2.0, 3.0), FEATURES[:2]),
    }
    return Knowledge(**{**told, **changes})


def test_all_comes_back(tmp_path):
    """Something of what was taught is lost overnight."""
    path = tmp_path / 'concepts.json'
    write_concepts(path, knowledge())
    assert read_concepts(path) == knowledge()
    assert repr(read_concepts(path)) == repr(knowledge())
    assert concepts_text(read_concepts(path)) == path.read_text()
    assert json.loads(path.read_text())['schema'] == 'al_questioner/concepts/1'


def test_the_groups_that_matter_are_those_that_were_named_last():
    """People who read the file would take what was said on the first day for what holds."""
    found = knowledge(lessons=(*knowledge().lessons, Lesson('day 1', 5, groups=('size',))))
    assert json.loads(concepts_text(found))['relevant_groups'] == ['size']


def test_the_fingerprint_is_that_of_the_file(tmp_path):
    """Nobody can find the file that a log speaks of."""
    import hashlib

    path = tmp_path / 'concepts.json'
    write_concepts(path, knowledge())
    assert fingerprint(knowledge()) == hashlib.sha256(path.read_bytes()).hexdigest()


def test_readable_numbers_keep_every_bit():
    """A feature that differs in its last bit is another view."""
    rng = np.random.default_rng(0)
    bits = rng.integers(0, 2**32, 200_000, dtype=np.uint32).view(np.float32)
    values = bits[np.isfinite(bits)]
    values = np.concatenate([values, np.float32([0.0, -0.0, 1e-45, -3.4028235e38, 0.1, 16777216])])
    text = json.dumps(readable(values.tolist()))
    assert np.float32(exact(json.loads(text), 'x')).tobytes() == values.tobytes()
    assert json.dumps(readable([float(np.float32(0.1))])) == '[0.1]'
    assert len(text) / len(values) < 18


def test_times_keep_their_nanoseconds():
    """Two answers within a microsecond change places."""
    for stamp in (0, 1, 1_764_347_912_123_456_789, time_of('0001-01-01T00:00:00Z')):
        assert time_of(time_text(stamp)) == stamp
    assert time_of('2025-11-28T16:38:32.5Z') == 1_764_347_912_500_000_000


def changed(**changes):
    return json.dumps({**json.loads(concepts_text(knowledge())), **changes})


def lesson(**changes):
    return changed(lessons=[{**json.loads(concepts_text(knowledge()))['lessons'][0], **changes}])


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('', 'not valid JSON'),
        (concepts_text(knowledge())[:300], 'not valid JSON'),
        ('[1]', 'no concepts file'),
        (changed(schema='al_questioner/concepts/2'), 'al_questioner/concepts/2.*reads al_questioner/concepts/1'),
        (changed(schema='al_questioner/query/1'), 'no concepts file'),
        (changed(symbols=[]), 'symbols'),
        (changed(symbols=['a', 'a']), 'distinct'),
        (changed(symbols=['none', 'snack', 'fruit']), 'cannot be a symbol'),
        (changed(symbols=['snack']), 'symbols'),
        (changed(kernel={}), 'kernel'),
        (changed(episodes=[]), 'not among the origins'),
        (lesson(labels=[{'view': 99, 'label': 'snack'}]), 'view 99 was not seen'),
        (lesson(labels=[{'view': 1, 'label': 'tool'}]), "unknown label 'tool'"),
        (lesson(groups=['smell']), "unknown feature group 'smell'"),
        (lesson(time='yesterday'), 'is not a time'),
        (lesson(turn=0), 'turn'),
        (changed(lessons=[{'episode': 'day 1', 'turn': 7, 'groups': ['size']}] * 2), 'turn 7 .*occurs twice'),
        (lesson(seen=[{'view': 1, 'object': 1, 'features': [1, 2]}]), 'has 2 features, expected 3'),
        (lesson(seen=[{'view': 1, 'object': 1, 'features': [1, 2, 'x']}]), 'not numbers'),
        (lesson(seen=[{'view': 1, 'object': 1, 'features': [1, 2, None]}]), 'not numbers'),
        (lesson(seen=[{'view': 1, 'object': 1, 'features': [1, 2, [3]]}]), 'not numbers'),
        (lesson(seen=[{'view': 1, 'object': 1, 'features': [1, 2, 1e39]}]), 'finite'),
        (lesson(seen=[{'view': 1, 'object': n, 'features': [1, 2, 3]} for n in (1, 2)]), 'view 1 occurs twice'),
        (lesson(seen=[{'view': n, 'object': 1, 'features': [1, 2, 3]} for n in (1, 2)]), 'seen twice'),
        (changed(lessons=[]).replace('"lessons": []', '"lessons": NaN'), 'no JSON number'),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(tmp_path, text, said):
    """A damaged file ends in a traceback, or is taken for a whole one."""
    path = tmp_path / 'concepts.json'
    path.write_text(text)
    with pytest.raises(InputError, match=said) as caught:
        read_concepts(path)
    assert str(caught.value).startswith(f'{path}: ')
    assert '\n' not in str(caught.value)


def test_no_file_and_no_text_are_refused(tmp_path):
    """A wrong path ends in a traceback."""
    for path, said in ((tmp_path / 'missing', 'cannot be read'), (tmp_path, 'is a folder; if it is that of a session')):
        with pytest.raises(InputError, match=said):
            read_concepts(path)
    (tmp_path / 'bytes').write_bytes(b'\xff\xfe\x00')
    with pytest.raises(InputError, match='not a text file'):
        read_concepts(tmp_path / 'bytes')


def test_later_versions_may_add_members():
    """A file that tells something more cannot be read."""
    assert concepts_of_text(changed(smell='fresh')) == knowledge()


def test_a_file_without_statistics_is_enough():
    """A file that a person wrote cannot be read."""
    document = json.loads(concepts_text(knowledge()))
    for name in ('standardisation', 'features_in_use', 'examples', 'groups', 'relevant_groups', 'teachers'):
        del document[name]
    assert concepts_of_text(json.dumps(document)) == knowledge(statistics=None, reliabilities={})


def places(value, path=()):
    """Yield the path of every value within a document."""
    yield path
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield from places(child, (*path, key))


def test_no_damage_ends_in_anything_but_a_refusal():
    """A file that somebody has edited ends in a traceback."""
    rng, text = np.random.default_rng(0), concepts_text(knowledge())
    everywhere = [path for path in places(json.loads(text)) if path]
    values = (None, -1, 0, 1, 2, 1.5, True, '', 'none', 'snack', [], {}, [1], {'a': 1}, 10**400, 'a\nb')
    refused = understood = 0
    for _ in range(1500):
        document = json.loads(text)
        *above, last = everywhere[rng.integers(len(everywhere))]
        parent = document
        for key in above:
            parent = parent[key]
        choice = int(rng.integers(-1, len(values)))
        if choice < 0:
            del parent[last]
        else:
            parent[last] = values[choice]
        try:
            found = concepts_of_text(json.dumps(document))
        except InputError as error:
            refused += '\n' not in str(error)
        else:
            assert concepts_text(concepts_of_text(concepts_text(found))) == concepts_text(found)
            taught_learner(found)
            understood += 1
    assert refused + understood == 1500
    assert refused > 700
