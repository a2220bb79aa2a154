"""How the appearance network was trained: views rendered, labelled by geometry, and learnt from."""
