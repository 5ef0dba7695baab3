"""What the scripts share. A module imports only what stands above it in the list of modules in scripts/README.md."""
