"""What the scripts share, in rooms; scripts/README.md has their order."""
