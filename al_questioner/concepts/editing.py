"""Changes of what is known: an example removed, a symbol renamed, dropped or added.

All return new knowledge. What followed from the old one, statistics and reliabilities, is left out of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from al_questioner.domain import NO_SYMBOL, InputError, Knowledge, Lesson
from al_questioner.domain.names import check_names, quoted, suggestion


def without_example(knowledge: Knowledge, view: int) -> Knowledge:
    """Return the knowledge without any label of a view, by the view's number; the view itself stays seen.

    Labels that were carried from it to other views of its object go, too.

    Raises:
        InputError: no view of this number has a label.
    """
    if not any(label.view == view for _, label in knowledge.examples):
        raise InputError(f'view {view} is no example; `concepts FILE --examples` lists them')
    return _changed(
        knowledge,
        lambda lesson: replace(
            lesson,
            labels=tuple(label for label in lesson.labels if view not in (label.view, label.carried_from)),
            hearsay=tuple(said for said in lesson.hearsay if said.view != view),
        ),
    )


def without_examples_of(knowledge: Knowledge, label: str) -> Knowledge:
    """Return the knowledge without the examples of a symbol, or of `NO_SYMBOL`; the views stay seen.

    Raises:
        InputError: there is none.
    """
    views = dict.fromkeys(example.view for _, example in knowledge.examples if example.label == label)
    if not views:
        raise InputError(f'there is no example of {quoted(label)}')
    for view in views:
        if any(example.view == view for _, example in knowledge.examples):
            knowledge = without_example(knowledge, view)
    return knowledge


def with_symbol(knowledge: Knowledge, symbol: str) -> Knowledge:
    """Return the knowledge with one more symbol, of which no example is known.

    Raises:
        InputError: there is one of this name, or people could not say it.
    """
    _check_new(knowledge, symbol)
    check_names((*knowledge.symbols, symbol), 'symbol')
    return replace(knowledge, symbols=(*knowledge.symbols, symbol), statistics=None, reliabilities={})


def with_symbol_renamed(knowledge: Knowledge, old: str, new: str) -> Knowledge:
    """Return the knowledge with another name for a symbol, as if it had always been called so.

    Raises:
        InputError: there is no such symbol, another one of the new name, or people could not say that.
    """
    _check_known(knowledge, old)
    symbols = tuple(new if symbol == old else symbol for symbol in knowledge.symbols)
    _check_new(knowledge, new)
    check_names(symbols, 'symbol')
    renamed = _relabelled(knowledge, old, new, symbols)
    origins = tuple(
        replace(origin, symbols=tuple(new if symbol == old else symbol for symbol in origin.symbols))
        for origin in knowledge.origins
    )
    return replace(renamed, origins=origins)


def without_symbol(knowledge: Knowledge, symbol: str) -> Knowledge:
    """Return the knowledge without a symbol: its examples are of none from now on, and do not matter.

    Raises:
        InputError: there is no such symbol, or fewer than two others.
    """
    _check_known(knowledge, symbol)
    symbols = tuple(name for name in knowledge.symbols if name != symbol)
    if len(symbols) < 2:
        raise InputError(f'without {quoted(symbol)} there would be fewer than two symbols')
    of_none = {label.view for _, label in knowledge.examples if label.label == symbol}
    changed = _relabelled(knowledge, symbol, NO_SYMBOL, symbols)
    return _changed(
        changed,
        lambda lesson: replace(
            lesson,
            judgements=tuple(
                replace(each, matters=each.matters and each.view not in of_none) for each in lesson.judgements
            ),
        ),
    )


def _relabelled(knowledge: Knowledge, old: str, new: str, symbols: tuple[str, ...]) -> Knowledge:
    """Return the knowledge of these symbols with one label for another."""

    def relabelled(lesson: Lesson) -> Lesson:
        labels = tuple(replace(each, label=new if each.label == old else each.label) for each in lesson.labels)
        hearsay = tuple(replace(said, label=new if said.label == old else said.label) for said in lesson.hearsay)
        return replace(lesson, labels=labels, hearsay=hearsay)

    lessons = tuple(map(relabelled, knowledge.lessons))
    return replace(knowledge, symbols=symbols, lessons=lessons, statistics=None, reliabilities={})


def _changed(knowledge: Knowledge, change: Callable[[Lesson], Lesson]) -> Knowledge:
    """Return the knowledge with all lessons changed; those that are empty then are left out."""
    lessons = tuple(lesson for lesson in map(change, knowledge.lessons) if not lesson.is_empty)
    return replace(knowledge, lessons=lessons, statistics=None, reliabilities={})


def _check_known(knowledge: Knowledge, symbol: str) -> None:
    if symbol not in knowledge.symbols:
        known = ', '.join(knowledge.symbols)
        raise InputError(f'unknown symbol {quoted(symbol)}; known: {known}{suggestion(symbol, knowledge.symbols)}')


def _check_new(knowledge: Knowledge, symbol: str) -> None:
    if symbol in knowledge.symbols:
        raise InputError(f'there is a symbol {quoted(symbol)} already')
