"""The manual's links: each relative link, image and anchor exists, and mkdocs.yml lists each page."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROOMS = [page for folder in ("native", "addon", "tools") for page in ROOT.glob(f"{folder}/**/README.md")]
PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("docs/**/*.md"), *ROOMS])

# A link or image: [text](target) or [text](target "title").
LINK = re.compile(r"\[[^\]]*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def prose(text):
    """The text without code, whose brackets are not links."""
    text = re.sub(r"^( *)(```|~~~).*?^\1\2[ \t]*$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", "", text)


def links(text):
    """Targets of all links and images that stay inside the repository."""
    return [target for target in LINK.findall(prose(text)) if not ELSEWHERE.match(target)]


def anchors(text):
    """Anchors of the headings that GitHub and MkDocs both make."""
    text = re.sub(r"^( *)(```|~~~).*?^\1\2[ \t]*$", "", text, flags=re.MULTILINE | re.DOTALL)
    found = set()
    for heading in re.findall(r"^#{1,6} +(.*?) *#*$", text, flags=re.MULTILINE):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        # The two disagree about a second heading of the same text, and about several dashes in a row.
        if "--" not in slug:
            found.add(slug)
    return found


def broken(page):
    """The broken links of a page."""
    wrong = []
    for target in links(page.read_text(encoding="utf-8")):
        path, _, anchor = target.partition("#")
        file = page if not path else page.parent / path
        if not file.exists():
            wrong.append(f"{target}: there is no {path}")
        elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text(encoding="utf-8")):
            wrong.append(f"{target}: {file.name} has no heading with that anchor")
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_images_and_anchors_exist(page):
    assert broken(page) == []


def test_mkdocs_lists_each_page_once():
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    listed = re.findall(r"^ +- [^:\n]+: (\S+\.md)$", text, flags=re.MULTILINE)
    there = [page.relative_to(ROOT / "docs").as_posix() for page in ROOT.glob("docs/**/*.md")]
    assert sorted(listed) == sorted(there)


def test_pages_of_the_manual_link_to_nothing_outside_of_it():
    """MkDocs copies docs/ alone."""
    outside = [
        f"{page.name}: {target}"
        for page in ROOT.glob("docs/**/*.md")
        for target in links(page.read_text(encoding="utf-8"))
        if not (page.parent / target.partition("#")[0]).resolve().is_relative_to(ROOT / "docs")
    ]
    assert outside == []


@pytest.mark.parametrize(
    "text, complaint",
    [
        ("[a](absent.md)", "absent.md: there is no absent.md"),
        ("![a](images/absent.png)", "images/absent.png: there is no images/absent.png"),
        ("# Here\n[a](#there)", "#there: page.md has no heading with that anchor"),
        ("[a](other.md#there)", "other.md#there: other.md has no heading with that anchor"),
    ],
)
def test_a_broken_link_is_found(tmp_path, text, complaint):
    (tmp_path / "page.md").write_text(text)
    (tmp_path / "other.md").write_text("# Other\n\n## What is here?\n")
    assert broken(tmp_path / "page.md") == [complaint]


def test_code_and_other_sites_are_not_followed(tmp_path):
    (tmp_path / "page.md").write_text(
        "# A `b` page\n`[a](absent.md)` [b](https://example.org/x) [c](#a-b-page)\n```\n[d](absent.md)\n```\n"
    )
    assert broken(tmp_path / "page.md") == []
