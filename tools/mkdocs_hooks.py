"""Differences of the site from the Markdown that GitHub shows.

A link to a file outside `docs/` becomes plain text, and the Python API has whole docstrings.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError

LINK = re.compile(r'(?<!!)\[([^\]]+)\]\(([^)\s:#]+)(?:#[^)\s]*)?\)')
API = 'reference/python_api.md'


def on_page_markdown(markdown: str, page: Any, config: Any, **_: Any) -> str:
    """Return the text of a page as the site needs it."""
    docs = Path(config['docs_dir'])
    place = (docs / page.file.src_uri).parent

    def inside(link: re.Match[str]) -> str:
        target = (place / link[2]).resolve()
        if not target.exists():
            raise PluginError(f'{page.file.src_uri} links to {link[2]}, which is not there')
        return link[0] if target.is_relative_to(docs) else link[1]

    if page.file.src_uri == API:
        return re.sub(r'(?m)^## (al_questioner[\w.]*)\n(?:(?!^## ).*\n)*', r'## \1\n\n::: \1\n\n', markdown)
    return LINK.sub(inside, markdown)
