"""What is made of the rows: cells, tables, figures, the page."""
