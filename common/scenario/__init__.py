"""What every scenario is made of, whoever owns a section of it: a task, and how tables become typed settings."""
