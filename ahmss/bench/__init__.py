"""What the system is measured by: `ahmss bench`, through real processes and a real server (Ichiguchi 2000, 5.4.1)."""
