/* SPDX-License-Identifier: Apache-2.0
 *
 * Areas are those of the projected triangles, cut at the pixels' borders: rays would have to be
 * many, since an error of a hundredth of a pixel counts. Lenses that bend straight lines do not
 * bend them visibly over so few pixels.
 */
#include "observe/lamp_picture.h"

#include "observe/lamp_profile.h"
#include "scene/camera.h"

#include <string.h>

#define HIDDEN 1e-3f /* of a distance: what is nearer than the lamp by as much hides it */
#define POINTS 6     /* across a triangle, to see whether something hides it */
#define MANY 64      /* triangles: then one point each */
#define CORNERS 8    /* of a triangle cut by a pixel: seven at most */

typedef struct lamp {
    const igi_scene *scene;
    const igi_tracer *tracer;
    const igi_camera *camera;
    const igi_light *light;
    uint32_t region;
    size_t triangles;
    igi_lamp_picture *picture;
} lamp;

static bool is_hidden(const lamp *s, igi_vec eye, igi_vec point)
{
    igi_vec d = igi_sub(point, eye);
    float distance = igi_length(d);
    igi_hit hit = igi_trace(s->tracer, eye, igi_scale(d, 1 / distance));
    return hit.triangle != IGI_NO_HIT && hit.distance < (1 - HIDDEN) * distance;
}

static bool triangle_is_hidden(const lamp *s, igi_vec eye, uint32_t triangle)
{
    int across = s->triangles > MANY ? 1 : POINTS;
    for (int i = 0; i < across; i++)
        for (int j = 0; i + j < across; j++) {
            float u = ((float)i + 1 / 3.0f) / (float)across,
                  v = ((float)j + 1 / 3.0f) / (float)across;
            if (is_hidden(s, eye, igi_triangle_point(&s->scene->mesh, triangle, u, v))) return true;
        }
    return false;
}

/* Where the corners of a triangle that shows its front lie: 1; its back: 0; not to be told: -1. */
static int project(const lamp *s, uint32_t triangle, double at[3][2])
{
    static const float corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    const igi_mesh *mesh = &s->scene->mesh;
    igi_vec eye = igi_camera_centre(s->camera);
    igi_vec toward = igi_sub(eye, igi_triangle_point(mesh, triangle, 0, 0));
    if (!(igi_dot(igi_tracer_normal(s->tracer, triangle), toward) > 0)) return 0;
    for (int k = 0; k < 3; k++) {
        igi_vec corner = igi_triangle_point(mesh, triangle, corners[k][0], corners[k][1]);
        if (!igi_camera_project(s->camera, corner, &at[k][0], &at[k][1])) return -1;
    }
    return triangle_is_hidden(s, eye, triangle) ? -1 : 1;
}

/* The window; false: part of the lamp is hidden or beyond the border, or it is too large. */
static bool find_window(lamp *s)
{
    const igi_mesh *mesh = &s->scene->mesh;
    const int size[2] = {s->camera->width, s->camera->height};
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, at[3][2];
    s->triangles = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        s->triangles += mesh->regions[t] == s->region;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        int shown = mesh->regions[t] == s->region ? project(s, t, at) : 0;
        if (shown < 0) return false;
        for (int k = 0; k < 6 && shown; k++) {
            low[k % 2] = fmin(low[k % 2], at[k / 2][k % 2]);
            high[k % 2] = fmax(high[k % 2], at[k / 2][k % 2]);
        }
    }
    for (int i = 0; i < 2; i++) {
        if (!(high[i] > low[i]) || high[i] - low[i] > IGI_LAMP_MOST) return false;
        if (!(low[i] > IGI_LAMP_MARGIN) || !(high[i] < size[i] - IGI_LAMP_MARGIN)) return false;
        s->picture->window[i][0] = (int)floor(low[i]) - IGI_LAMP_MARGIN;
        s->picture->window[i][1] = (int)ceil(high[i]) + IGI_LAMP_MARGIN;
    }
    return true;
}

/* Cuts a convex polygon off where sign * (coordinate - limit) is positive (Sutherland and Hodgman
 * 1974); the corners that are left. */
static int cut(double polygon[CORNERS][2], int count, int axis, double limit, double sign)
{
    double left[CORNERS][2];
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const double *a = polygon[i], *b = polygon[(i + 1) % count];
        double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
        if (da <= 0) memcpy(left[kept++], a, sizeof *left);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            double t = da / (da - db);
            for (int k = 0; k < 2; k++) left[kept][k] = a[k] + t * (b[k] - a[k]);
            kept++;
        }
    }
    memcpy(polygon, left, sizeof left);
    return kept;
}

static double area_in_pixel(double triangle[3][2], int x, int y)
{
    double polygon[CORNERS][2] = {{0}}, twice = 0;
    memcpy(polygon, triangle, 3 * sizeof *polygon);
    int n = cut(polygon, 3, 0, x, -1);
    n = cut(polygon, n, 0, x + 1, 1);
    n = cut(polygon, n, 1, y, -1);
    n = cut(polygon, n, 1, y + 1, 1);
    for (int i = 0; i < n; i++) {
        const double *a = polygon[i], *b = polygon[(i + 1) % n];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * fabs(twice);
}

/* c of the window's pixels; their sum, and the mean profile. */
static double cover(const lamp *s)
{
    double at[3][2], sum = 0, profiles = 0;
    memset(s->picture->covered, 0, sizeof s->picture->covered);
    for (uint32_t t = 0; t < s->scene->mesh.triangle_count; t++) {
        if (s->scene->mesh.regions[t] != s->region || project(s, t, at) <= 0) continue;
        double profile = igi_lamp_profile_seen(s->scene, s->light, s->camera, t, 1 / 3.0f,
                                               1 / 3.0f);
        for (int y = s->picture->window[1][0]; y < s->picture->window[1][1]; y++)
            for (int x = s->picture->window[0][0]; x < s->picture->window[0][1]; x++) {
                double area = area_in_pixel(at, x, y);
                s->picture->covered[y - s->picture->window[1][0]][x - s->picture->window[0][0]] +=
                    area;
                sum += area;
                profiles += area * profile;
            }
    }
    s->picture->profile = sum > 0 ? profiles / sum : 0;
    return sum;
}

bool igi_lamp_picture_find(const igi_scene *scene, const igi_tracer *tracer,
                           const igi_camera *camera, const igi_light *light,
                           igi_lamp_picture *picture)
{
    lamp s = {.scene = scene,
              .tracer = tracer,
              .camera = camera,
              .light = light,
              .region = (uint32_t)light->region,
              .picture = picture};
    if (!find_window(&s)) return false;
    picture->area_px = cover(&s);
    return picture->area_px > 0;
}
