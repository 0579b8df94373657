#include "tree/skeleton.h"
