"""Objects that may lie on a table: vessels, food and clutter, and the catalogues of the tasks."""
