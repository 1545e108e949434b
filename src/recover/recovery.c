/* SPDX-License-Identifier: Apache-2.0
 *
 * What a recovery is asked for, and what it leaves: names, defaults, memory.
 */
#include "base/context.h"

#include <igi/recover.h>

#include <string.h>

const char *igi_method_name(igi_method method)
{
    switch (method) {
    case IGI_METHOD_PATCHES: return "patches";
    case IGI_METHOD_GATHER: return "gather";
    case IGI_METHOD_RADIOSITY: return "radiosity";
    case IGI_METHOD_DIRECT: return "direct";
    case IGI_METHOD_YU99: return "yu99";
    }
    return "unknown";
}

bool igi_method_from_name(const char *name, igi_method *method)
{
    for (int m = IGI_METHOD_PATCHES; m <= IGI_METHOD_YU99; m++)
        if (strcmp(name, igi_method_name((igi_method)m)) == 0) {
            *method = (igi_method)m;
            return true;
        }
    return false;
}

void igi_recover_options_init(igi_recover_options *options)
{
    *options = (igi_recover_options){.struct_size = sizeof *options, .model = IGI_ANY_MODEL};
}

void igi_recovery_destroy(igi_recovery *recovery)
{
    if (!recovery) return;
    igi_materials_destroy(recovery->materials);
    igi_free(recovery->evidence);
    igi_free(recovery->read);
    igi_registered_destroy(recovery->registered);
    for (size_t i = 0; i < recovery->comparison_count; i++) {
        igi_free(recovery->comparisons[i].frame);
        igi_image_destroy(recovery->comparisons[i].photo);
        igi_image_destroy(recovery->comparisons[i].prediction);
        igi_image_destroy(recovery->comparisons[i].albedo);
    }
    igi_free(recovery->comparisons);
    igi_free(recovery);
}
