"""The site of the documentation, for Sphinx: the pages as they stand in the repository, and what is made from sources.

tools/site runs it, and sets VBOND_SITE: the folder of what was made before, extra/library and extra/reports.
"""
import os
import re
from pathlib import Path

root = Path(__file__).resolve().parent.parent.parent
made = Path(os.environ["VBOND_SITE"])

project = "vbond"
release = re.search(r"project\(vbond VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())[1]
copyright = re.search(r"Copyright \(c\) (.*)", (root / "LICENSE").read_text())[1]
root_doc = "README"
include_patterns = ["*.md", "bench/**.md", "docs/**.md", "docs/**.ipynb", "examples/*.md", "packaging/*.md", "tests/fuzz/*.md", "web/*.md"]
exclude_patterns = ["build", ".git", "**/node_modules", "docs/site/contents.md"]
extensions = ["myst_parser", "nbsphinx", "sphinx.ext.autodoc", "sphinx_copybutton"]

html_theme = "furo"
html_title = f"vbond {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_extra_path = [str(made / "extra")]
html_copy_source = False
html_show_search_summary = False  # texts that scripts cannot read in pages opened as files

myst_heading_anchors = 4  # as those that links between the pages already use
nbsphinx_execute = "always"
nbsphinx_requirejs_path = ""  # nothing that pages would ask the network for
nbsphinx_assume_equations = False
autodoc_default_options = {"members": True, "imported-members": True, "inherited-members": "BaseException,OSError",
                           "member-order": "groupwise"}

# ---- pages that are more on the site than in the repository -------------------------------------------------------

pages_of_examples = [p.stem for p in (root / "examples").glob("*.md")]


def page_of(case):
    """The page of an example: the one with the longest name that the name of its case begins with."""
    return max((p for p in pages_of_examples if case.startswith(p)), key=len)  # ValueError: a case without a page


cases = sorted(p.stem for p in (root / "examples").glob("*.toml"))
cases_of = {page: [c for c in cases if page_of(c) == page] for page in pages_of_examples}


def shown_case(case):
    report = f"reports/{case}.html"
    text = [f"\n## {case}.toml\n"]
    if (made / "extra" / report).exists():
        text += ["```{raw} html", f'<p><a href="../{report}">The report alone</a></p>',
                 f'<iframe class="report" src="../{report}" title="Report of {case}.toml" loading="lazy"></iframe>', "```"]
    return "\n".join([*text, f"```{{literalinclude}} {case}.toml", ":language: toml", "```", ""])


def extend(_, name, source):
    """The contents for the sidebar; cases and reports of examples. Links to folders, of which a site has no pages,
    become plain text."""
    if name == "README":
        source[0] += (root / "docs/site/contents.md").read_text()
    elif name.startswith("examples/"):
        source[0] += "".join(map(shown_case, cases_of[name.removeprefix("examples/")]))
    if not name.startswith("docs/notebooks/"):
        source[0] = re.sub(r"\[([^]]*)\]\([^)]*/\)", r"\1", source[0])


def mend_theme(app, failure):
    """Debian's furo leaves its script a module in two files and takes a style from another package: neither works in
    pages that are opened as files."""
    if failure is not None:
        return  # which is told then
    static = Path(app.outdir) / "_static"
    script, part, style = static / "scripts/furo.js", static / "scripts/gumshoe-patched.js", static / "styles/furo.css"
    script.write_text(part.read_text() + re.sub(r"^import Gumshoe .*$", "", script.read_text(), flags=re.M))
    normal = Path("/usr/share/nodejs/normalize.css/normalize.css").read_text()
    style.write_text(normal + style.read_text().replace("@import url(/javascript/normalize.css/normalize.css);", ""))


def setup(app):
    app.connect("source-read", extend)
    app.connect("build-finished", mend_theme)
