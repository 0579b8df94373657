#include "snow/scene/statistics.h"

namespace snowbough::snow {
namespace {

void add(SnowBalance& sum, const SnowBalance& other) {
  sum.deposited_volume += other.deposited_volume;
  sum.slid_volume += other.slid_volume;
  sum.held_volume += other.held_volume;
  sum.landed_volume += other.landed_volume;
  sum.removed_volume += other.removed_volume;
  sum.masked_volume += other.masked_volume;
  sum.pressed_volume += other.pressed_volume;
  sum.cleared_volume += other.cleared_volume;
  sum.melted_volume += other.melted_volume;
  sum.drifted_volume += other.drifted_volume;
  sum.stretched_volume += other.stretched_volume;
  sum.visible_area += other.visible_area;
  sum.back_face_area += other.back_face_area;
}

}  // namespace

StatisticsPair balance_of(const shared::ObjectSums& sums) {
  StatisticsPair pair;
  SnowBalance& step = pair.step;
  step.deposited_volume = sums.deposited;
  step.slid_volume = sums.slid;
  step.held_volume = sums.held;
  step.landed_volume = sums.landed;
  step.removed_volume = sums.removed;
  step.stretched_volume =
      sums.held - (sums.held_before + sums.deposited + sums.landed - sums.slid - sums.removed);
  step.visible_area = sums.visible_area;
  step.back_face_area = sums.back_face_area;

  SnowBalance& total = pair.total;
  total.deposited_volume = sums.total_deposited;
  total.slid_volume = sums.total_slid;
  total.held_volume = sums.held;
  total.landed_volume = sums.total_landed;
  total.masked_volume = sums.total_masked;
  total.pressed_volume = sums.total_pressed;
  total.cleared_volume = sums.total_cleared;
  total.melted_volume = sums.total_melted;
  total.drifted_volume = sums.total_drifted;
  total.removed_volume = sums.total_masked + sums.total_pressed + sums.total_cleared +
                         sums.total_melted + sums.total_drifted;
  total.stretched_volume = sums.total_stretched;
  total.visible_area = sums.total_visible_area;
  // Back faces have no total: only the current value matters.
  total.back_face_area = step.back_face_area;
  return pair;
}

void add_balance(StatisticsPair& sum, const StatisticsPair& other) {
  add(sum.step, other.step);
  add(sum.total, other.total);
}

}  // namespace snowbough::snow
