"""The main process, one for each virtual human: its five parts by their names (Ichiguchi 2000, 4.2.4)."""
