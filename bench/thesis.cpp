#include "bench/thesis.hpp"

namespace erard::bench {
namespace {

double mean(const Distribution& d) { return d.count > 0 ? d.total / static_cast<double>(d.count) : d.kNone; }

}  // namespace

std::vector<ThesisLine> beside_thesis(const std::vector<Row>& rows) {
  struct Variant {
    FeltModel felts;
    const char* model;
    double thesis;
  };
  const Variant variants[] = {
      {FeltModel::bodies, "6 bodies, 14 felts as bodies, 14 contacts", kThesisSlowness * kThesisStep},
      {FeltModel::massless, "6 bodies, 14 felts without mass, 14 contacts", kThesisSlowness * kThesisStep},
      {FeltModel::rigid, "the same without felt laws", kThesisFeltlessSlowness * kThesisStep}};
  std::vector<ThesisLine> lines;
  for (const Variant& variant : variants) {
    const Row* row = find_row(rows, {"piano", 1, 1 / kThesisStep, "cheapest", 1, Engine::erard, variant.felts});
    if (row != nullptr) lines.push_back({variant.model, variant.thesis, mean(row->tick), mean(row->undisturbed)});
  }
  return lines;
}

std::string thesis_note() {
  return "Thesis 6.4.1: \"about 20 s\" for 1 s of motion on a laptop with an Intel Core i5, h = 0.5 ms, felts as "
         "bodies, a\n"
         "general 3-D engine (XDE); 1.2 s before the felt laws, written outside that engine, were synchronised with "
         "it\n"
         "(5.5.2). What its contacts were like then it does not say; here they are rigid. Means, as it has them.\n";
}

}  // namespace erard::bench
