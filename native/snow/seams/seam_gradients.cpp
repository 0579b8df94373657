#include "snow/seams/seam_gradients.h"

#include <algorithm>
#include <utility>

namespace snowbough::snow {
namespace {

double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < b.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum;
}

/// The normal matrix times `from`, whose entries behind the unknowns are 0.
void multiply(const std::vector<SeamRow>& rows, float damping, const std::vector<float>& from,
              std::vector<float>& to) {
  for (size_t i = 0; i < from.size(); ++i) to[i] = damping * from[i];
  for (const SeamRow& row : rows) {
    float sum = 0.0f;
    for (int32_t t = 0; t < kSeamTerms; ++t) sum += row.weight[t] * from[row.source[t]];
    for (int32_t t = 0; t < kSeamTerms; ++t) to[row.source[t]] += row.weight[t] * sum;
  }
}

}  // namespace

void solve_by_gradients(const std::vector<SeamRow>& rows, int32_t sources, float damping,
                        int32_t rounds, std::vector<float>& values) {
  std::vector<float> solution(values.size(), 0.0f);
  std::vector<float>& rest = values;
  std::vector<float> direction(static_cast<size_t>(sources), 0.0f);
  std::vector<float> product(static_cast<size_t>(sources));
  std::copy(rest.begin(), rest.end(), direction.begin());
  double rest_squared = dot(rest, rest);
  for (int32_t round = 0; round < rounds && rest_squared > 0.0; ++round) {
    multiply(rows, damping, direction, product);
    const auto step = static_cast<float>(rest_squared / dot(product, direction));
    for (size_t i = 0; i < rest.size(); ++i) {
      solution[i] += step * direction[i];
      rest[i] -= step * product[i];
    }
    const double before = std::exchange(rest_squared, dot(rest, rest));
    const auto keep = static_cast<float>(rest_squared / before);
    for (size_t i = 0; i < rest.size(); ++i) direction[i] = rest[i] + keep * direction[i];
  }
  values = std::move(solution);
}

}  // namespace snowbough::snow
