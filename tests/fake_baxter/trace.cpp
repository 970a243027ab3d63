// SPDX-License-Identifier: MIT
#include "fake_baxter/node.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate::fake_baxter {

Trace::Trace(const std::string& file) {
  if (file.empty()) return;
  out_.open(file);
  if (!out_) throw Error(file, "cannot be written");
  out_ << "t,x,y,z,set_z,force,mode,commands,fault\n";
}

void Trace::write(const Body& body) {
  if (!out_.is_open()) return;
  const Eigen::Vector3d tip = body.tip();
  out_ << fmt::format("{:.2f},{:.5f},{:.5f},{:.5f},{:.5f},{:.3f},{},{},{}\n", body.now(), tip.x(), tip.y(), tip.z(),
                      body.set_point_height(), body.pressing(), name_of(body.mode()), body.commands(),
                      body.faulty() ? 1 : 0);
  if (++rows_ % 50 == 0) out_.flush();
}

}  // namespace palpate::fake_baxter
