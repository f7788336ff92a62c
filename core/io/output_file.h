// Where writers find the file that they write to.
#pragma once

#include "cloud/output_file.h"
