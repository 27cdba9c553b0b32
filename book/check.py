"""Checks the built book: every link and picture within it is there, every anchor too, every chapter is listed and has text.

    mdbook build book && python3 book/check.py

Needs Python and nothing else, and no network: links to other sites are counted, not followed.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

HERE = Path(__file__).resolve().parent


class Page(HTMLParser):
    """Links, pictures and anchors of one page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.pictures, self.anchors, self.text, self.skipped = [], [], set(), 0, 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors.update(values[key] for key in ("id", "name") if values.get(key))
        self.skipped += tag in ("script", "style")
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        if tag in ("img", "source") and values.get("src"):
            self.pictures.append(values["src"])
        if tag == "img" and not values.get("alt", "").strip():
            self.pictures.append("NO-ALT:" + values.get("src", "?"))

    def handle_endtag(self, tag):
        self.skipped -= tag in ("script", "style")

    def handle_data(self, data):
        self.text += 0 if self.skipped else len(data.strip())


def main():
    book = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "book"
    source = HERE / "src"
    if not (book / "index.html").exists():
        sys.exit(f"{book}: no built book; run `mdbook build book` first")
    pages = {path.resolve(): Page(path) for path in book.rglob("*.html")}
    faults, inner, outer = [], 0, 0
    for path, page in pages.items():
        shown = path.relative_to(book.resolve())
        for picture in page.pictures:
            if picture.startswith("NO-ALT:"):
                faults.append(f"{shown}: {picture[7:]} has no text for who does not see it")
            elif not picture.startswith("data:"):
                inner += 1
                if urlsplit(picture).scheme or not (path.parent / unquote(picture)).exists():
                    faults.append(f"{shown}: picture {picture} is not there")
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or link.startswith("//"):
                outer += 1
                continue
            inner += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                faults.append(f"{shown}: {link} leads nowhere")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                faults.append(f"{shown}: {link} has no such place")
    listed = (source / "SUMMARY.md").read_text(encoding="utf-8")
    for chapter in source.rglob("*.md"):
        name = chapter.relative_to(source).as_posix()
        if name in ("SUMMARY.md", "images/PROVENANCE.md"):
            continue
        text = chapter.read_text(encoding="utf-8")
        if f"({name})" not in listed:
            faults.append(f"{name}: not in SUMMARY.md")
        if len(text) < 500:
            faults.append(f"{name}: {len(text)} characters, hardly a chapter")
        if any(word in text.lower() for word in ("coming soon", "todo", "tbd")):
            faults.append(f"{name}: unfinished")
    told = (source / "images" / "PROVENANCE.md").read_text(encoding="utf-8")
    patterns = [part.strip() for row in told.splitlines() if row.startswith("| `") for part in row.split("`")[1].split(",")]
    for picture in (source / "images").rglob("*.*"):
        if picture.suffix != ".md" and not any(picture.match(pattern) for pattern in patterns):
            faults.append(f"{picture.relative_to(source)}: PROVENANCE.md does not say where it comes from")
    print("\n".join(faults) or f"{len(pages)} pages, {inner} links and pictures within, {outer} links to elsewhere not followed: all there")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
