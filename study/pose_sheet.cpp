#include "study/pose_sheet.hpp"

#include <fmt/format.h>

#include "erard/device/output_file.hpp"
#include "study/defaults.hpp"

namespace erard::study {
namespace {

/// The document of one pose as an element of the sheet. All have the same style sheet: only the first keeps it.
std::string placed(std::string document, double x, double y, bool keeps_style) {
  constexpr const char *kOpen = "<style>", *kClose = "</style>";
  const std::size_t open = document.find(kOpen), close = document.find(kClose);
  if (!keeps_style && open != std::string::npos && close != std::string::npos)
    document.erase(open, close + std::string(kClose).size() - open);
  return document.insert(document.find("<svg") + 4, fmt::format(" x=\"{:.6g}\" y=\"{:.6g}\"", x, y));
}

}  // namespace

void draw_poses(const std::filesystem::path& svg, const ActionFile& action, const std::vector<Pose>& poses,
                DriveKind drive, const Box& view, int columns) {
  constexpr double kPixels = 3;   // of draw_svg() [px/mm]
  constexpr double kCaption = 9;  // height of its caption [mm]
  Scene scene = build_scene(action, load_drawing(default_action_file()));
  scene.view = view;
  const double width = kPixels * (view.right - view.left), height = kPixels * (view.top - view.bottom + kCaption);
  const int rows = (static_cast<int>(poses.size()) + columns - 1) / columns;
  std::string sheet = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.6g} {:.6g}\">\n",
                                  columns * width, rows * height);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    sheet += placed(draw_svg(scene, poses[i].snapshot, drive, poses[i].caption), column * width, row * height, i == 0);
    for (auto& label : scene.label_at) label.reset();  // names once
  }
  OutputFile file(svg);
  file.write(sheet + "</svg>\n");
  file.commit();
}

}  // namespace erard::study
