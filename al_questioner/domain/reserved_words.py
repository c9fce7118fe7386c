"""Words that cannot be names because they mean something else in an answer, in English and in other languages."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from al_questioner.domain.query import NO_SYMBOL

UNKNOWN_WORDS = ('?', 'unknown')
SKIP_WORDS = ('skip',)
NOTHING_WORDS = ('nothing', 'n')
FEATURES_WORDS = ('features', 'feature', 'f')
HELP_WORDS = ('help', 'h')


def _words(table: str) -> tuple[str, ...]:
    return tuple(' '.join(word.split()) for word in table.split(','))


OTHER_LANGUAGES = MappingProxyType(
    {
        NO_SYMBOL: _words("""
            kein, keine, keiner, keines, keins, nichts, nein, aucun, aucune, rien, non, ninguno, ninguna, ningún,
            nadie, nada, nessuno, nessuna, niente, nulla, nenhum, nenhuma, ninguém, geen, niets, niks, niemand, nee,
            ingen, inget, inga, intet, ingenting, nej, nei, ei mitään, ei mikään, ei yhtään, enginn, ekkert, żaden,
            żadna, żadne, nic, brak, nikt, nie, žádný, žádná, žádné, žiadny, žiadna, žiadne, nič, nikto, nijeden,
            nijedan, nijedna, ništa, nobeden, ne, semmi, egyik sem, nincs, niciunul, niciuna, nimic, niciun, asnjë,
            asgjë, nėra, joks, nieko, neviens, nekas, mitte ükski, puudub, bat ere ez, xejn, dim byd, yok, hiçbiri,
            hiçbir şey, hayır, heç biri, tidak ada, tiada, tidak, bukan, không, không có, không có gì, wala, hakuna,
            hapana, κανένα, κανένας, καμία, κανείς, τίποτα, όχι, нет, ничего, никто, ни один, никакой, немає, нічого,
            жоден, ні, няма, нищо, нито един, ништа, ниједан, нема, ниту еден, нічога, жоқ, なし, ない, 無, 无, 無し,
            いいえ, 何もない, 没有, 沒有, 都不是, 不是, 없음, 없다, 아니요, 없어요, لا, لا شيء, لا أحد, لا يوجد, هیچ,
            هیچکدام, هیچ کدام, نه, کوئی نہیں, کچھ نہیں, نہیں, כלום, אף אחד, אין, לא, कोई नहीं, कुछ नहीं, नहीं,
            काहीही नाही, नाही, কোনোটিই না, কিছুই না, না, ਕੋਈ ਨਹੀਂ, ਨਹੀਂ, કોઈ નહીં, ஏதுமில்லை, எதுவும் இல்லை, இல்லை,
            ఏదీ కాదు, ఏమీ లేదు, లేదు, ಯಾವುದೂ ಇಲ್ಲ, ഒന്നുമില്ല, ไม่มี, ไม่, არა, არაფერი, ոչ մեկը, ոչինչ
        """),
        'unknown': _words("""
            unbekannt, weiß nicht, ich weiß nicht, weiß ich nicht, keine ahnung, inconnu, inconnue, je ne sais pas,
            sais pas, desconocido, desconocida, no sé, no lo sé, sconosciuto, sconosciuta, non so, non lo so,
            desconhecido, desconhecida, não sei, desconegut, no ho sé, descoñecido, non sei, onbekend, weet ik niet,
            ik weet het niet, okänd, okänt, vet inte, vet ej, ukendt, ved ikke, ukjent, vet ikke, tuntematon,
            en tiedä, óþekkt, veit ekki, nieznany, nieznane, nie wiem, neznámý, neznámé, nevím, neznámy, neviem,
            nepoznato, nepoznat, ne znam, neznano, ne vem, ismeretlen, nem tudom, necunoscut, nu știu, i panjohur,
            nuk e di, nežinomas, nežinau, nezināms, nezinu, tundmatu, ei tea, ezezaguna, ez dakit, bilinmiyor,
            bilinmeyen, bilmiyorum, naməlum, bilmirəm, tidak tahu, tidak diketahui, không biết, không rõ,
            hindi ko alam, sijui, haijulikani, άγνωστο, άγνωστος, δεν ξέρω, неизвестно, неизвестный, не знаю, незнаю,
            невідомо, невядома, не ведаю, неизвестен, не знам, непознато, белгісіз, 不明, 未知, 不知道,
            不清楚, わからない, 分からない, 分かりません, わかりません, 知らない,
            모름, 모르겠어요, 모르겠습니다, 몰라요, 알 수 없음,
            مجهول, غير معروف, لا أعرف, لا أدري, ناشناس, نامشخص, نمی‌دانم, نمیدانم, نامعلوم, معلوم نہیں, לא ידוע,
            לא יודע, לא יודעת, अज्ञात, पता नहीं, मालूम नहीं, माहित नाही, অজানা, জানি না, ਪਤਾ ਨਹੀਂ, ખબર નથી, தெரியாது,
            தெரியவில்லை, తెలియదు, ಗೊತ್ತಿಲ್ಲ, അറിയില്ല, ไม่รู้, ไม่ทราบ, უცნობია, არ ვიცი, անհայտ, չգիտեմ
        """),
        'skip': _words("""
            überspringen, auslassen, weiter, passer, sauter, ignorer, omitir, saltar, salta, saltare, pular, ometre,
            overslaan, hoppa, hoppa över, spring over, hopp over, hoppe over, ohita, sleppa, pomiń, pominąć,
            přeskočit, přeskoč, preskočiť, preskoč, preskoči, preskočiti, kihagy, kihagyás, omite, treci peste,
            kapërce, praleisti, izlaist, jäta vahele, saltatu, atla, geç, keç, lewati, lewatkan, langkau, bỏ qua,
            laktawan, παράλειψη, παράβλεψη, пропустить, пропуск, пропусти, пропустити, прапусціць, прескочи, өткізу,
            スキップ, 飛ばす, 跳过, 跳過, 略过, 略過, 건너뛰기, 건너뛰다, تخطي, تخطى, تجاوز, رد کردن, رد شدن, چھوڑیں,
            דלג, לדלג, छोड़ें, छोड़ो, वगळा, বাদ দিন, এড়িয়ে যান, ਛੱਡੋ, છોડો, தவிர், தவிர்க்கவும், దాటవేయి,
            ಬಿಟ್ಟುಬಿಡಿ, ഒഴിവാക്കുക, ข้าม, გამოტოვება, բաց թողնել
        """),
    }
)
"""Words of other languages for each of our words; a teacher who types one means our word, not a symbol."""

RESERVED: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(
            (NO_SYMBOL, 'no', 'null', 'nil', 'n/a', 'none of these', 'none of them', 'no symbol', 'neither', 'nope'),
            'says that a thing belongs to no symbol',
        ),
        **dict.fromkeys(
            (
                *UNKNOWN_WORDS,
                *_words("idk, dunno, don't know, dont know, do not know, i don't know, i dont know, i do not know"),
                *_words('not sure, no idea, not known'),
            ),
            'says that the teacher does not know',
        ),
        **dict.fromkeys((*SKIP_WORDS, 'skip it', 'skip this'), 'skips a question'),
        **dict.fromkeys(NOTHING_WORDS, 'stands for nothing'),
        **dict.fromkeys(FEATURES_WORDS, 'asks which properties matter'),
        **dict.fromkeys(HELP_WORDS, 'asks for help'),
        'u': 'is the key of "I do not know"',
        's': 'is the key of "skip"',
        'undo': 'takes an answer back',
        'z': 'takes an answer back',
        **dict.fromkeys(
            _words('pass, cancel, stop, back, exit, done, next, yes, true, false'), 'is what people say to a program'
        ),
        'quit': 'ends the conversation',
        'q': 'ends the conversation',
        **{word: f'means {ours!r}' for ours, words in OTHER_LANGUAGES.items() for word in words},
    }
)
"""Words that cannot be names in any of our programs, and what each means."""
KEYS = frozenset(word for word in RESERVED if len(word) == 1 and word.isascii() and word.isalpha())
"""Reserved words of a single letter; they are allowed as names where names have no keys."""
