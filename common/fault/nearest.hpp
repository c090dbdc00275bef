#pragma once
#include <optional>
#include <string>
#include <vector>

namespace tact {

/// For "did you mean": the candidate nearest to `word` by edit distance, if near enough to be a slip (at most a third
/// of its letters). A candidate that begins with `word` counts as one wrong letter.
std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace tact
