"""What a result says, whoever shows it: statements, tables, panels and scenes with stable ids, in SI."""
