"""HTML of the Markdown of this project's pages and reports, without anything that another place would have to give."""

import re

import markdown

# What lib/pages/document.py escapes beside what Markdown does; and what means something in HTML.
ESCAPED, ENTITIES = "|~$", {"\\<": "&lt;", "\\>": "&gt;", "\\&": "&amp;"}
PICTURE = re.compile(r"^!\[.*\]\([^)]*\)\n(\n\*.*\*\n)?", re.MULTILINE)  # of a report, with its caption
PLACE = re.compile(r' ?\(?<a href="(?!https?:)[^"]*">(.*?)</a>\)?')  # a link within the repository, as (more)


def as_html(text):
    """Returns the HTML of some Markdown. Pictures, and links to other files, are left out."""
    writer = markdown.Markdown(extensions=["tables", "sane_lists"])
    writer.ESCAPED_CHARS.extend(ESCAPED)
    for kind, name in ((writer.preprocessors, "html_block"), (writer.inlinePatterns, "html")):
        kind.deregister(name)  # what looks like HTML is text
    html = writer.convert(re.sub(r"\\[<>&]", lambda found: ENTITIES[found[0]], PICTURE.sub("", text)))
    html = PLACE.sub(lambda link: "" if link[0].endswith(")") else f" {link[1]}", html)
    return re.sub(r"<(/?)h([1-4])>", lambda tag: f"<{tag[1]}h{int(tag[2]) + 2}>", html).replace(
        "<table>", '<div class="wide" tabindex="0"><table>').replace("</table>", "</table></div>")


def section_of(text, heading):
    """Returns what stands under a heading of the second level."""
    return text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0].strip()
