"""Build the harness's Windows programs from C++ with mingw-w64, and run them with Wine."""
