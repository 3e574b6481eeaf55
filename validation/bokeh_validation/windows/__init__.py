"""Windows programs of the harness: C++ sources, their build with mingw-w64, and Wine to run them elsewhere."""
