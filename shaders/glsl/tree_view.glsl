// The uniform block of a picture, see TreeView.
#include "lib/tree_shared.h"

layout(std140) uniform ViewBlock { TreeView view; };
