"""check_links.py FOLDER: whether all that the pages of a site refer to is in its folder, with its anchors.

Sphinx has judged the links that it made itself; here are those of raw HTML, downloads, pictures and frames, too. Left
alone: addresses elsewhere, and what is inside of reports and of doxygen's pages. The status is 1 if a link is broken.
"""
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

site = Path(sys.argv[1]).resolve()


class Page(HTMLParser):
    def __init__(self, file):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(file.read_text())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.links.append((self.getpos()[0], value))
            elif name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)


foreign = {site / "reports", site / "library"}
pages = {file: Page(file) for file in site.rglob("*.html") if not foreign & set(file.parents)}
checked = broken = 0
for file, page in pages.items():
    for line, link in page.links:
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        checked += 1
        target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
        missing_anchor = target in pages and parts.fragment and unquote(parts.fragment) not in pages[target].anchors
        if not target.exists() or missing_anchor:
            broken += 1
            print(f"{file.relative_to(site)}:{line}: broken link: {link}", file=sys.stderr)
print(f"{len(pages)} pages, {checked} links, {broken} broken")
sys.exit(1 if broken else 0)
