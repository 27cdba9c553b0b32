"""Opens reports and the built book in headless Chromium: no error on the console, no missing image, screenshots to look at.

Set-up, once:   pip install playwright && playwright install chromium      (or a Chromium of the system: --chromium PATH)
Use:            mdbook build book && jamscope --out report ... then
                python3 book/headless.py --shots shots jamscope-report/report.html book/book

A folder stands for all its HTML pages. Ends with 1 and a line for each fault found. Optional: nothing else needs it.
"""

import argparse
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

BROKEN = "() => [...document.images].filter(i => !i.complete || i.naturalWidth === 0).map(i => i.getAttribute('src'))"
WIDER = "() => Math.max(0, document.documentElement.scrollWidth - document.documentElement.clientWidth)"


def pages(paths):
    for path in map(Path, paths):
        if not path.exists():
            sys.exit(f"{path}: not there")
        # 404.html is for a server: its addresses begin at the root of one.
        yield from (page for page in sorted(path.rglob("*.html")) if page.name != "404.html") if path.is_dir() else [path]


def name(page):
    return "-".join(page.with_suffix("").parts[-3:]).strip("/").replace("..", "")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="+", help="HTML files, or folders of them")
    parser.add_argument("--shots", type=Path, help="folder for a screenshot of every page")
    parser.add_argument("--figures", action="store_true", help="a screenshot of every figure of a page as well")
    parser.add_argument("--chromium", help="a Chromium of the system instead of playwright's")
    parser.add_argument("--width", type=int, default=1280, help="width of the window [px]")
    arguments = parser.parse_args()
    if arguments.shots:
        arguments.shots.mkdir(parents=True, exist_ok=True)
    faults, count = [], 0
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=arguments.chromium, args=["--no-sandbox"])
        tab = browser.new_page(viewport={"width": arguments.width, "height": 900})
        # What a page asks of the network is a fault: books and reports are read without one.
        tab.on("console", lambda message: message.type == "error" and faults.append(f"{tab.url}: {message.text}"))
        tab.on("pageerror", lambda error: faults.append(f"{tab.url}: {error}"))
        tab.on("request", lambda asked: asked.url.startswith("http") and faults.append(f"{tab.url}: asks for {asked.url}"))
        for page in pages(arguments.paths):
            tab.goto(page.resolve().as_uri())
            tab.wait_for_load_state("load")
            faults += [f"{page}: image {source} is missing" for source in tab.evaluate(BROKEN)]
            # The shell of mdBook may scroll by itself; a page wider than its window is cut off on paper and phones.
            wider = tab.evaluate(WIDER)
            if wider:
                faults.append(f"{page}: {wider} px wider than the window")
            if arguments.shots:
                tab.screenshot(path=arguments.shots / f"{name(page)}.png", full_page=True)
            if arguments.shots and arguments.figures:
                for index, figure in enumerate(tab.query_selector_all("figure")):
                    figure.screenshot(path=arguments.shots / f"{name(page)}-{index + 1:02}.png")
            count += 1
        browser.close()
    print("\n".join(dict.fromkeys(faults)) or f"{count} pages: no error, no missing image, nothing asked of the network")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
