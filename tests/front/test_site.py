"""The web site: every page has one place in its navigation, and what pages link to comes with them."""

import re

import pytest

from barrierbench_analysis.front import site
from barrierbench_analysis.io.errors import UserError
from barrierbench_analysis.io.places import ROOT


def tree(root, **files):
    for name, text in files.items():
        path = root / name.replace("__", "/").replace("_md", ".md").replace("_json", ".json")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def test_pages_come_with_what_they_link_to(tmp_path):
    tree(tmp_path, README_md="[a](docs/a.md#x) [b](https://b.c)", docs__a_md="[c](../configs/c.json) ![p](p_json.json)", configs__c_json="{}", configs__d_json="{}", docs__p_json="{}",
         examples__e_md="[f](../nothing.md)")
    (tmp_path / "docs/p.json").rename(tmp_path / "docs/p_json.json")
    assert site.staged(tmp_path) == ["README.md", "docs/a.md", "configs/c.json", "docs/p_json.json"]
    assert site.stage(tmp_path, tmp_path / "out") and (tmp_path / "out/configs/c.json").read_text() == "{}"
    tree(tmp_path, docs__a_md="[e](../examples/e.md)")
    for page, said in (("[e](../examples/e.md)", "examples/e.md: found a link to nothing.md"), ("[e](../configs)", "docs/a.md: found a link to configs")):
        tree(tmp_path, docs__a_md=page)
        with pytest.raises(UserError, match=said):
            site.staged(tmp_path)


def test_lists_have_an_empty_line_before_them():
    text = "What:\n- a\n  more of a\n- b\n  - c\n\nText\n1. one\n\n```sh\nx\n- no item\n```\n- new\nafter\n- last\n"
    made = site.blank_before_lists(text)
    assert made == text.replace("What:\n- a", "What:\n\n- a").replace("Text\n1.", "Text\n\n1.").replace("```\n- new", "```\n\n- new")


def leaves(entries) -> list[str]:
    return [page for entry in entries for page in ([entry] if isinstance(entry, str) else leaves([*entry.values()] if not isinstance(next(iter(entry.values())), list) else next(iter(entry.values()))))]


def test_the_navigation_has_every_page_once_by_section():
    names = ["README.md", "docs/guides/b.md", "docs/guides/index.md", "docs/results/method/m.md", "docs/results/a.md", "results/R.md", "docs/words.md", "configs/c.json"]
    made = site.navigation(names)
    assert made == [{"Home": "README.md"}, {"Guides": ["docs/guides/index.md", "docs/guides/b.md"]},
                    {"Results": ["docs/results/a.md", {"Method": ["docs/results/method/m.md"]}, {"Studies": ["results/R.md"]}]}, {"Project": ["docs/words.md"]}]  # fmt: skip
    ours = site.staged(ROOT)
    pages = [name for name in ours if name.endswith(".md")]
    assert len(pages) > 80 and sorted(leaves(site.navigation(ours))) == sorted(pages)


def test_no_page_of_ours_loses_a_link():
    """Errors of `staged` are those that the build would have; the extensions that formulas and lists need are loaded."""
    assert len(site.staged(ROOT)) > 120
    config, recipe = (ROOT / "mkdocs.yml").read_text(), site.REQUIREMENTS.read_text()
    assert all(re.search(rf"^{name}==", recipe, re.M) for name in ("mkdocs", "mkdocs-material", "django-static-mathjax", "mdx_truly_sane_lists"))
    assert "arithmatex" in config and "scripts/tex-svg.js" in config and "http" not in config


def test_the_site_is_built_without_a_warning():
    if not (site.ENVIRONMENT / "recipe").is_file():
        pytest.skip("the packages of the site are not installed: ./bench dev site")
    assert site.main([]) == 0 and (site.SITE / "docs/guides/index.html").is_file()
    text = (site.SITE / "docs/guides/index.html").read_text()
    assert re.findall(r'src="([^"]+)"', text) and [of for of in re.findall(r'(?:src|href)="(https?://[^"]+)"', text) if "squidfunk" not in of] == []
    page = site.PAGES / "docs/words.md"
    page.write_text(page.read_text() + "\n[x](limits.md#nowhere)\n")
    assert not site.built(site.ENVIRONMENT / "bin/python")
