"""Sphinx settings of the book. `make book` builds it; what is special lives in _ext/."""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

# Before numpy: the same numbers and the same speed on every machine, and in the kernels.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("PYDEVD_DISABLE_FILE_VALIDATION", "1")

import chapters
import equation_pages
import offline
import outputs
import reference_pages

import projflow_lite

offline.copy_scripts()
outputs.forget_old()
outputs.open_cache()
chapters.write_chapters()
equation_pages.write_equation_pages()
reference_pages.write_reference()

project = "projflow_lite"
author = "The projflow_lite authors"
copyright = author
version = release = projflow_lite.__version__
language = "en"
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx.ext.mathjax",
    "docstrings",
    "equation_links",
    "live_pages",
    "reference_pages",
    "study_results",
]
exclude_patterns = ["_build", "_ext", "results", "pictures", "**.ipynb_checkpoints"]
default_role = "py:obj"  # a name in single backticks in a docstring

# Notebooks are run by the build and remembered until they or the package change.
nb_execution_mode = "cache"
nb_execution_cache_path = str(outputs.CACHE)
nb_execution_excludepatterns = [f"chapters/{name}" for name in outputs.not_run()]
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_execution_show_tb = True
nb_merge_streams = True
nb_ipywidgets_js = {}  # live_pages brings its own, which need no network
myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 2
myst_links_external_new_tab = False

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_type_aliases = {"ArrayLike": "ArrayLike", "NDArray": "NDArray"}
napoleon_attr_annotations = False  # np.bool_ would be read as a link
napoleon_use_ivar = True
napoleon_numpy_docstring = False
python_use_unqualified_type_names = True
toc_object_entries = False  # every page copies the whole table of contents: this halves the build

html_context = {"default_mode": "auto"}  # without it the theme complains in the console
html_theme = "sphinx_book_theme"
html_title = "projflow_lite"
html_static_path = ["_static", "_build/static"]
html_css_files = ["book.css"]
html_show_search_summary = False  # summaries are fetched, which no page on a disk may do
html_copy_source = False
html_show_copyright = False
mathjax_path = "vendor/mathjax.js"

# A launch button needs the public address of a repository, which this one does not have yet:
# BOOK_REPOSITORY=https://… make book turns it on, together with "edit this page".
repository = os.environ.get("BOOK_REPOSITORY", "")
html_theme_options = {
    "use_download_button": False,  # each chapter ends with the notebook itself
    "use_fullscreen_button": True,
    "show_toc_level": 2,
    "show_navbar_depth": 1,
    "home_page_in_toc": False,
    "navbar_persistent": [],  # the search field stands in the sidebar
    "pygments_light_style": "a11y-light",
    "pygments_dark_style": "a11y-dark",
}
if repository:
    html_theme_options |= {
        "repository_url": repository,
        "path_to_docs": "book",
        "use_repository_button": True,
        "launch_buttons": {"binderhub_url": os.environ.get("BOOK_BINDER", "https://mybinder.org")},
    }
