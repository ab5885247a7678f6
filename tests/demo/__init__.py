"""The table scenario, played once and measured."""
