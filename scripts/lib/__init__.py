"""What the scripts share. An import goes down the list of layers in scripts/README.md, never up."""
