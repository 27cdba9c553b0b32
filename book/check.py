"""Checks the book: links, anchors, pictures, the list of chapters, and the number of words.

    python3 book/check.py                  # the sources in book/src
    python3 book/check.py --built [DIR]    # the pages of `mdbook build book` too, by default in book/book

Of the sources: every link between chapters, every anchor and every picture exists, every chapter is in SUMMARY.md, every picture has its row in
images/PROVENANCE.md. Words are those of the text, without code blocks and tables: at most 12 000 in part one, 900 in a chapter of part two, 40 000 in
all chapters. Needs Python and nothing else, and no network: links to other sites are counted, not followed.
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

HERE = Path(__file__).resolve().parent
SOURCE = HERE / "src"
PART_ONE, METHOD, WHOLE = 12_000, 900, 40_000
# Not chapters.
OTHER = ("SUMMARY.md", "images/PROVENANCE.md")


def without_code(text):
    """The lines outside of code blocks."""
    lines, inside = [], False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            inside = not inside
        elif not inside:
            lines.append(line)
    return lines


def word_count(text):
    lines = [line for line in without_code(text) if not line.lstrip().startswith(("|", "<!--"))]
    plain = re.sub(r"\]\([^)\s]*\)", "]", "\n".join(lines))
    return sum(any(letter.isalnum() for letter in word) for word in plain.split())


def anchor(title):
    """The anchor that mdbook gives to a title."""
    title = re.sub(r"\]\([^)]*\)", "", title)
    kept = (letter for letter in title.strip().lower() if letter.isalnum() or letter in " _-")
    return "".join(kept).replace(" ", "-")


def anchors(text):
    found, times = set(), {}
    for line in without_code(text):
        if match := re.match(r"#+\s+(.*)", line):
            name = anchor(match[1])
            times[name] = times.get(name, -1) + 1
            found.add(f"{name}-{times[name]}" if times[name] else name)
    return found


def links(text):
    """Targets of the links and pictures; code between backquotes is none."""
    plain = re.sub(r"`[^`\n]*`", "", "\n".join(without_code(text)))
    return re.findall(r"\]\(([^)\s]+)\)", plain)


def listed():
    """Chapters in the order of SUMMARY.md, each with its part."""
    part, found = "before part one", []
    for line in (SOURCE / "SUMMARY.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("# ") and line != "# Summary":
            part = line[2:].split(":")[0].strip()
        found += [(part, name) for name in re.findall(r"\]\(([^)]+)\)", line)]
    return found


def check_links(texts, faults):
    inner = outer = 0
    places = {name: anchors(text) for name, text in texts.items()}
    for name, text in texts.items():
        for link in links(text):
            parts = urlsplit(link)
            if parts.scheme:
                outer += 1
                continue
            inner += 1
            target = ((SOURCE / name).parent / unquote(parts.path)).resolve() if parts.path else SOURCE / name
            if not target.exists():
                faults.append(f"{name}: {link} is not there")
            elif parts.fragment and target.suffix == ".md":
                key = target.relative_to(SOURCE).as_posix()
                if unquote(parts.fragment) not in places.get(key, {unquote(parts.fragment)}):
                    faults.append(f"{name}: {link} has no such place")
    return inner, outer


def check_list(texts, faults):
    names = [name for _, name in listed()]
    faults += [f"{name}: not in SUMMARY.md" for name in texts if name not in OTHER and name not in names]
    faults += [f"SUMMARY.md: {name} is listed twice" for name in sorted(set(names)) if names.count(name) > 1]
    for name, text in texts.items():
        if name not in OTHER and len(text) < 500:
            faults.append(f"{name}: {len(text)} characters, hardly a chapter")
        if any(word in text.lower() for word in ("coming soon", "todo", "tbd")):
            faults.append(f"{name}: unfinished")


def check_pictures(texts, faults):
    rows = [line for line in texts["images/PROVENANCE.md"].splitlines() if line.startswith("| `")]
    patterns = [part.strip() for row in rows for part in row.split("`")[1].split(",")]
    shown = {((SOURCE / name).parent / unquote(link)).resolve() for name, text in texts.items() for link in links(text)}
    for picture in sorted((SOURCE / "images").rglob("*.*")):
        name = picture.relative_to(SOURCE).as_posix()
        if picture.suffix != ".md" and not any(picture.match(pattern) for pattern in patterns):
            faults.append(f"{name}: PROVENANCE.md does not say where it comes from")
        if picture.suffix != ".md" and picture not in shown:
            faults.append(f"{name}: no chapter shows it")


def check_words(texts, faults):
    words = {}
    for part, name in listed():
        if name in texts:
            words.setdefault(part, {})[name] = word_count(texts[name])
    for part, chapters in words.items():
        print(f"{sum(chapters.values()):6} words in {len(chapters):2} chapters: {part}")
    one, whole = (sum(words.get("Part one", {}).values()), sum(count for chapters in words.values() for count in chapters.values()))
    print(f"{whole:6} words in all")
    if one > PART_ONE:
        faults.append(f"part one: {one} words, more than {PART_ONE}")
    for name, count in words.get("Part two", {}).items():
        if count > METHOD:
            faults.append(f"{name}: {count} words, more than {METHOD}")
    if whole > WHOLE:
        faults.append(f"the book: {whole} words, more than {WHOLE}")


class Page(HTMLParser):
    """Links, pictures and anchors of one built page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.pictures, self.anchors = [], [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors.update(values[key] for key in ("id", "name") if values.get(key))
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        if tag in ("img", "source") and values.get("src"):
            self.pictures.append((values["src"], bool(values.get("alt", "").strip()) or tag == "source"))


def check_built(book, faults):
    if not (book / "index.html").exists():
        sys.exit(f"{book}: no built book; run `mdbook build book` first")
    pages = {path.resolve(): Page(path) for path in book.rglob("*.html")}
    for path, page in pages.items():
        shown = path.relative_to(book.resolve())
        for picture, has_text in page.pictures:
            if not has_text:
                faults.append(f"{shown}: {picture} has no text for who does not see it")
            if not picture.startswith("data:") and (urlsplit(picture).scheme or not (path.parent / unquote(picture)).exists()):
                faults.append(f"{shown}: picture {picture} is not there")
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or link.startswith("//"):
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                faults.append(f"{shown}: {link} leads nowhere")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                faults.append(f"{shown}: {link} has no such place")
    print(f"{len(pages)} built pages")


def main():
    faults = []
    texts = {path.relative_to(SOURCE).as_posix(): path.read_text(encoding="utf-8") for path in sorted(SOURCE.rglob("*.md"))}
    inner, outer = check_links(texts, faults)
    check_list(texts, faults)
    check_pictures(texts, faults)
    check_words(texts, faults)
    if sys.argv[1:2] == ["--built"]:
        check_built(Path(sys.argv[2]) if len(sys.argv) > 2 else HERE / "book", faults)
    print(f"{len(texts)} files, {inner} links and pictures within, {outer} links to elsewhere not followed")
    print("\n".join(faults) or "all there")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
