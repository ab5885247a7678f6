"""Walking (Ichiguchi 2000, 5.3.2 and appendix A): the clips, how they are made, chosen, shrunk, turned and bent."""
