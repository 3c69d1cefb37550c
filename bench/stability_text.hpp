// What docs/stability.md says between its tables.
#pragma once
namespace erard::bench {
inline constexpr const char* kHead = "# x {} {} {:.2f}\n![map](images/stability.svg)\n\n", *kMargins = "\n## M\n", *kHolding = "\n## H\n", *kHoldingBrake = "\n## B\n", *kHoldingStop = "\n## S\n", *kFidelity = "\n## F\n", *kPassivity = "\n## P\n", *kRemedies = "\n## R\n", *kLimits = "\n";
}
