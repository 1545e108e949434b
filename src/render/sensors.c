/* SPDX-License-Identifier: Apache-2.0
 *
 * Light meters: points that belong to no surface, and the irradiance of the side that they face. A
 * sensor's paths come in a few large stratified batches, whose spread is the result's variance.
 */
#include "base/file.h"
#include "base/parallel.h"
#include "base/spectrum.h"
#include "render/path.h"
#include "scene/file_text.h"

#include <string.h>

#define BATCHES 16
#define MOST_PATHS ((size_t)1 << 20) /* of a batch */
#define FILE_LIMIT ((size_t)64 << 20)

typedef struct sensor {
    igi_vec point, normal;
    double irradiance[IGI_MAX_BANDS];
    double lux, lux_std; /* in watts of white light; or of all bands, where they are no colours */
} sensor;

typedef struct meter {
    const igi_renderer *renderer;
    const igi_render_options *options;
    double target;
    uint64_t key;
    sensor *sensors;
    size_t count, capacity;
} meter;

static double weigh_bands(const double *value, int bands)
{
    if (bands == 3) return igi_luminance(value);
    double sum = 0;
    for (int b = 0; b < bands; b++) sum += value[b] / bands;
    return sum;
}

/* The mean irradiance of a batch of `count` paths, a power of two. */
static uint64_t run_batch(const meter *m, const sensor *s, uint64_t key, size_t count, double *mean)
{
    int bands = m->renderer->bands;
    uint64_t rays = 0;
    for (int b = 0; b < bands; b++) mean[b] = 0;
    for (size_t i = 0; i < count; i++) {
        float irradiance[IGI_MAX_BANDS] = {0};
        sampler points = {key, (uint32_t)i, (uint32_t)count - 1, 0};
        rays += trace_irradiance(m->renderer, s->point, s->normal, m->options->max_depth, &points,
                                 irradiance);
        for (int b = 0; b < bands; b++) mean[b] += (double)irradiance[b] / (double)count;
    }
    return rays;
}

static igi_status measure(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    const meter *m = user;
    sensor *s = &m->sensors[index];
    int bands = m->renderer->bands;
    size_t batch = 1;
    while (batch * BATCHES < (size_t)m->options->samples * IGI_SENSOR_PATHS) batch *= 2;
    for (;; batch *= 2) {
        double sum = 0, squares = 0, mean[IGI_MAX_BANDS];
        uint64_t rays = 0;
        for (int b = 0; b < bands; b++) s->irradiance[b] = 0;
        for (int k = 0; k < BATCHES; k++) {
            uint64_t key = igi_hash64(igi_hash64(m->key ^ index) ^ (uint64_t)k);
            rays += run_batch(m, s, key, batch, mean);
            for (int b = 0; b < bands; b++) s->irradiance[b] += mean[b] / BATCHES;
            double value = weigh_bands(mean, bands);
            sum += value / BATCHES;
            squares += value * value / BATCHES;
        }
        igi_count_rays(ctx, rays);
        s->lux = sum;
        s->lux_std = sqrt(fmax(0.0, squares - sum * sum) / (BATCHES - 1));
        if (!(m->target > 0 && s->lux_std > m->target * sum) || batch >= MOST_PATHS) break;
    }
    return IGI_OK;
}

/* A line: X Y Z, then the way it faces; blanks, tabs, commas or semicolons between. */
static igi_status read_line(igi_context *ctx, const char *path, int line, const char *at, sensor *s)
{
    double value[6];
    for (int k = 0; k < 6; k++) {
        if (!igi_scan_number(&at, &value[k]) || !(fabs(value[k]) < 1e9))
            return igi_fail(ctx, IGI_E_DATA,
                            "%s:%d: no place and direction; give six numbers, X Y Z in metres and "
                            "the way that the sensor faces",
                            path, line);
        at += strspn(at, " \t,;");
    }
    s->point = igi_v_ofd(value);
    s->normal = igi_v_ofd(value + 3);
    if (!(igi_length(s->normal) > 1e-6f))
        return igi_fail(ctx, IGI_E_DATA, "%s:%d: the direction has no length", path, line);
    s->normal = igi_normalize(s->normal);
    if (*at && *at != '\r' && *at != '#')
        return igi_fail(ctx, IGI_E_DATA, "%s:%d: more than six numbers", path, line);
    return IGI_OK;
}

static igi_status read_sensors(igi_context *ctx, const char *path, meter *m)
{
    igi_text text = {NULL, 0};
    igi_status status = IGI_OK;
    int line = 0;
    IGI_TRY_GOTO(igi_text_load(ctx, path, FILE_LIMIT, &text));
    for (char *at = text.bytes, *end; *at; at = end) {
        line++;
        end = at + strcspn(at, "\n");
        if (*end) *end++ = 0;
        at += strspn(at, " \t\r");
        if (!*at || *at == '#') continue;
        sensor *grown = igi_grow(ctx, m->sensors, &m->capacity, m->count + 1, sizeof *grown);
        if (!grown) {
            status = IGI_E_SYSTEM;
            goto cleanup;
        }
        m->sensors = grown;
        IGI_TRY_GOTO(read_line(ctx, path, line, at, &m->sensors[m->count++]));
    }
    if (m->count == 0)
        status = igi_fail(ctx, IGI_E_DATA, "%s: no sensor; give lines of six numbers", path);
cleanup:
    igi_free(text.bytes);
    return status;
}

static void print_table(const meter *m, FILE *file)
{
    int bands = m->renderer->bands;
    fprintf(file, "x,y,z,normal_x,normal_y,normal_z,illuminance_lx,illuminance_std_lx");
    for (int b = 0; b < bands; b++) fprintf(file, ",irradiance_%d", b);
    for (size_t i = 0; i < m->count; i++) {
        const sensor *s = &m->sensors[i];
        fprintf(file, "\n%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.3g", (double)s->point.x,
                (double)s->point.y, (double)s->point.z, (double)s->normal.x, (double)s->normal.y,
                (double)s->normal.z, IGI_LUMENS_PER_WATT * s->lux,
                IGI_LUMENS_PER_WATT * s->lux_std);
        for (int b = 0; b < bands; b++) fprintf(file, ",%.7g", s->irradiance[b]);
    }
    fputc('\n', file);
}

igi_status igi_sensors_measure(igi_context *ctx, const igi_renderer *renderer, const char *path,
                               const igi_render_options *options, double target, const char *table,
                               double *noise)
{
    meter m = {.renderer = renderer,
               .options = options,
               .target = target,
               .key = igi_hash64(igi_seed(ctx) ^ 0x53454e53)};
    igi_status status = IGI_OK;
    *noise = 0;
    IGI_TRY_GOTO(read_sensors(ctx, path, &m));
    IGI_TRY_GOTO(igi_parallel_for(ctx, m.count, measure, &m));
    for (size_t i = 0; i < m.count; i++)
        if (m.sensors[i].lux > 0) *noise = fmax(*noise, m.sensors[i].lux_std / m.sensors[i].lux);
    igi_file file;
    IGI_TRY_GOTO(igi_file_begin(ctx, table, &file));
    print_table(&m, file.stream);
    status = igi_file_end(ctx, &file, IGI_OK);
cleanup:
    igi_free(m.sensors);
    return status;
}
