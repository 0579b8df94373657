// The picture's uniform block, see TreeView.
#include "lib/tree_shared.h"

layout(std140) uniform ViewBlock { TreeView view; };
