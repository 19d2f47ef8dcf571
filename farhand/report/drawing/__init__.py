"""Charts over time and the path in space, as SVG and as numbers for the page."""
