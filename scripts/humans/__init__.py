"""How the shipped humans are modelled: signed distances along the bones, meshed, joined, painted and skinned."""
