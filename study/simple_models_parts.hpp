// The numbers of Tables 2.1 and 2.2 against each other and against this action, for the section.
#pragma once

#include <string>

#include "study/simple_models.hpp"

namespace erard::study::simple {

/// Table 2.2, what follows from Table 2.1, and what this action has.
std::string parts_table(const SimpleModelsStudy& study);

/// Printed numbers of chapter 2 that other printed numbers contradict. (C_w of the parts and the whippen's spring:
/// thesis_tables.)
std::vector<Contradiction> contradictions();

}  // namespace erard::study::simple
