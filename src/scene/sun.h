/* SPDX-License-Identifier: Apache-2.0
 *
 * Where the sun stands.
 */
#ifndef IGI_SRC_SCENE_SUN_H
#define IGI_SRC_SCENE_SUN_H

#include "scene/json.h"

#include <igi/scene.h>

/* Elevation above the horizon and azimuth from north over east, degrees, for a time in days since
 * 2000-01-01 12:00 UTC; within .02 degrees from 1950 to 2050, without refraction. */
void igi_sun_position(double days, double latitude_deg, double longitude_deg, double *elevation_deg,
                      double *azimuth_deg);

/* "2026-06-21T12:00:00+02:00" (seconds may be left out, Z for UTC) to such days; false: no time. */
bool igi_days_of_time(const char *text, double *days);

/* The keys of a light of "type": "sky". */
IGI_MUST_USE igi_status igi_sky_read(igi_context *ctx, const igi_json *at, igi_sky *sky);

#endif
