#include "tree/tubes/detail.h"

namespace snowbough::tree {

DetailSettings detail_settings(Detail detail) {
  switch (detail) {
    case Detail::kDraft:
      return {8, 4e-4, 0.5, 2.0, 5e-4, 12000, 1.6};
    case Detail::kGame:
      return {16, 3e-4, 0.28, 0.5, 5e-4, 25000, 1.7};
    case Detail::kDefault:
      return {16, 1.5e-4, 0.17, 0.17, 5e-4, 55000, 3.0};
    case Detail::kFilm:
      break;
  }
  return {32, 2e-5, 0.1, 0.1, 4e-4, 400000, 12.0};
}

}  // namespace snowbough::tree
