"""Records of cards, and the model that predicts them."""
