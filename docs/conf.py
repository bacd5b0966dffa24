"""Sphinx configuration. Examples run and tables are printed from the code: see `_extensions`."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_extensions"))

import teleopdesign  # noqa: E402

project = "teleopdesign"
author = copyright = "teleopdesign authors"
version = release = teleopdesign.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "executed",
    "catalogue",
    "mathml",
    "docstrings",
]
exclude_patterns = ["_build", "_generated", "examples"]
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
# imported for type checkers only; unknown, it would leave all names of that class unresolved
autodoc_type_aliases = {"xarray.Dataset": "xarray.Dataset"}
python_use_unqualified_type_names = True
maximum_signature_line_length = 80

html_math_renderer = "mathml"
html_theme = "furo"
html_title = f"teleopdesign {version}"
html_static_path = ["_static"]
html_css_files = ["teleopdesign.css"]
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0072B2", "color-brand-content": "#0072B2"},
    "dark_css_variables": {"color-brand-primary": "#56B4E9", "color-brand-content": "#56B4E9"},
}
pygments_style = "default"
