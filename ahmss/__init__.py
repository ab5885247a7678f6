"""AHMSS, the Affordance-based Human Motion Synthesizing System (after Ichiguchi, Kyoto University, 2000)."""

__version__ = "0.1.0"
