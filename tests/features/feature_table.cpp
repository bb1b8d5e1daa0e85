// Writes docs/step_solver_features.md to the standard output.
#include <iostream>

#include "tests/features/table.hpp"

int main() { std::cout << bb::features::page(bb::features::table()); }
