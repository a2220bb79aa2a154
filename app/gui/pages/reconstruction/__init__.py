"""The page that shows the reconstructed model: its shape, its crop box, how far it can be trusted."""
