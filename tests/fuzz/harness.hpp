// SPDX-License-Identifier: MIT
// The doors by which bytes of others come in, each as a function of any bytes. An Error is an answer and is caught
// inside; what comes out, a crash and a broken promise (std::logic_error) are what is looked for. tests/fuzz.sh feeds
// them what libFuzzer makes up, `./check` what is kept in corpus/.
#pragma once

#include <string>
#include <vector>

namespace palpate::fuzz {

struct Door {
  const char* name;  ///< of the folder in corpus/, too
  void (*open)(const std::string& bytes);
};

/// A config as a file: read, composed with the shipped groups, resolved. What is accepted, written and read again has
/// the same id.
void config(const std::string& bytes);
/// A word behind `palpate run` and `palpate sweep`, and a condition as in `where`.
void words(const std::string& bytes);
/// record.jsonl or config.yaml of a run (the first byte says which) whose other file is sound, read as status, replay
/// and report read them.
void record(const std::string& bytes);
/// manifest.jsonl and config.yaml of a sweep.
void plan(const std::string& bytes);
/// The archive of a bundle, before it is compressed.
void bundle(const std::string& bytes);
/// A line from a program of the backend `process`. What is accepted is a height that the arm can have felt.
void answer(const std::string& bytes);
/// A table that the backend `replay` answers from.
void table(const std::string& bytes);
/// A mesh as STL, OBJ or PLY (the first byte says which), made a surface.
void mesh(const std::string& bytes);
/// A height map as CSV, NPY or PNG (the first byte says which), read as a grid. What is accepted is heights alone.
void heights(const std::string& bytes);
/// What a program answers that is an acquisition: the begin of an array and its header. What is accepted says that six
/// numbers follow.
void scores(const std::string& bytes);
/// What a master of ROS answers when it is asked for its network.
void xmlrpc(const std::string& bytes);

/// All that this build has: without ROS there is no xmlrpc, without Embree and assimp no mesh.
const std::vector<Door>& doors();

}  // namespace palpate::fuzz
