/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras: transforms.json, COLMAP's text and binary, and the photographs that they name.
 */
#include "scene_fixture.h"

#include "scene/camera.h"

#define FOLDER "scratch_scene_cameras"

static igi_context *ctx;
static igi_frame *frames;
static size_t frame_count;

static void finish(void)
{
    igi_frames_destroy(frames, frame_count);
    igi_context_destroy(ctx);
    frames = NULL;
    ctx = NULL;
}

static bool load(const char *name)
{
    char path[512];
    finish();
    ctx = test_context(1);
    snprintf(path, sizeof path, FOLDER "/%s", name);
    igi_status status = igi_frames_load(ctx, path, &frames, &frame_count);
    CHECK(status == IGI_OK || status == IGI_E_DATA);
    CHECK((status == IGI_OK) == (frames != NULL));
    return status == IGI_OK;
}

static bool transforms(const char *text)
{
    write_text("t.json", text);
    return load("t.json");
}

static void check_refused(const char *text, const char *sentence)
{
    CHECK(!transforms(text));
    CHECK_CONTAINS(igi_context_message(ctx), sentence);
}

static void all_keys(void)
{
    write_fixture(FOLDER);
    CHECK(transforms(
        "{\"camera_model\":\"OPENCV\",\"w\":100.0,\"h\":50,\"fl_x\":80,\"fl_y\":81,"
        "\"cx\":49,\"cy\":26,\"k1\":0.1,\"k2\":0.2,\"k3\":0.3,\"p1\":0.4,\"p2\":0.5,"
        "\"aabb_scale\":16,\"ply_file_path\":\"x.ply\",\"frames\":["
        "{\"file_path\":\"./images/b.c.png\",\"sharpness\":3,\"transform_matrix\":" POSE "},"
        "{\"file_path\":\"images/a\",\"fl_x\":70,\"k1\":0,\"transform_matrix\":"
        "[[0,0,2,1],[2,0,0,2],[0,2,0,3]]}]}"));
    CHECK(frame_count == 2);
    if (frame_count == 2) {
        const igi_camera *c = &frames[0].camera;
        CHECK_STR(frames[0].name, "b.c");
        CHECK_STR(frames[0].path, FOLDER "/./images/b.c.png"); /* not there: as it is named */
        CHECK(c->width == 100 && c->height == 50 && c->fl_x == 80 && c->fl_y == 81);
        CHECK(c->cx == 49 && c->cy == 26 && c->k1 == .1 && c->k2 == .2 && c->k3 == .3);
        CHECK(c->p1 == .4 && c->p2 == .5);
        CHECK(c->camera_to_world[2][3] == .9 && c->camera_to_world[1][1] == 1);
        c = &frames[1].camera; /* its own keys win; a scaled rotation is made one */
        CHECK(c->fl_x == 70 && c->fl_y == 81 && c->k1 == 0 && c->k2 == .2);
        CHECK_STR(frames[1].path, FOLDER "/images/a.exr");
        CHECK_NEAR(c->camera_to_world[0][2], 1, 1e-15);
        CHECK_NEAR(c->camera_to_world[1][0], 1, 1e-15);
        CHECK(c->camera_to_world[1][3] == 2);
    }
    finish();
}

static void intrinsics_by_default(void)
{
    write_fixture(FOLDER);
    CHECK(transforms("{\"camera_angle_x\":1.5707963267948966,\"w\":100,\"h\":60,\"frames\":["
                     "{\"file_path\":\"none\",\"transform_matrix\":" POSE "}]}"));
    if (frames) CHECK_NEAR(frames[0].camera.fl_x, 50, 1e-9);
    if (frames) CHECK_NEAR(frames[0].camera.fl_y, 50, 1e-9);
    if (frames) CHECK(frames[0].camera.cx == 50 && frames[0].camera.cy == 30);
    CHECK(transforms("{\"fl_x\":5,\"frames\":["
                     "{\"file_path\":\"images/a.exr\",\"transform_matrix\":" POSE "}]}"));
    if (frames) CHECK(frames[0].camera.width == 8 && frames[0].camera.height == 6);
    finish();
}

#define ONE(keys, matrix) \
    "{\n" keys "\"frames\":[\n{\"file_path\":\"a\",\n\"transform_matrix\":" matrix "}]}"

static void bad_transforms(void)
{
    write_fixture(FOLDER);
    const char *const whd = "t.json:3: \"frames[0]\": ";
    check_refused(ONE("\"w\":8,\"h\":6,", POSE), whd);
    CHECK_CONTAINS(igi_context_message(ctx), "no focal length");
    check_refused(ONE("\"w\":8.5,\"h\":6,\"fl_x\":5,", POSE), "must be whole numbers of pixels");
    check_refused(ONE("\"fl_x\":5,", POSE), "no \"w\" and \"h\", and " FOLDER "/a does not tell");
    check_refused(ONE("\"w\":8,\"h\":6,\"fl_x\":-5,", POSE), "the focal length must be above 0");
    check_refused(ONE("\"w\":8,\"h\":6,\"fl_x\":5,\"k4\":1,", POSE), "undistort");
    check_refused(ONE("\"w\":8,\"h\":6,\"fl_x\":\"5\",", POSE), "t.json:2: \"fl_x\": is a string");
    check_refused(ONE("\"camera_model\":\"OPENCV_FISHEYE\",", POSE),
                  "t.json:2: \"camera_model\": ");
    check_refused(ONE("\"is_fisheye\":true,", POSE), "undistort the images");
#define GOOD "\"w\":8,\"h\":6,\"fl_x\":5,"
    check_refused(ONE(GOOD, "[[1,0,0,0],[0,1,0,0]]"),
                  "t.json:4: \"frames[0].transform_matrix\": has 2");
    check_refused(ONE(GOOD, "[[1,0,0,0],[0,1,0],[0,0,1,0]]"),
                  "transform_matrix[1]\": has 3 numbers");
    check_refused(ONE(GOOD, "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]"), "must be 0 0 0 1");
    check_refused(ONE(GOOD, "[[1,0,0,0],[0,1,0,0],[0,0,0,0]]"), "is no rotation and translation");
    check_refused(ONE(GOOD, "[[1,0,0,0],[0,2,0,0],[0,0,1,0]]"), "is no rotation and translation");
    check_refused(ONE(GOOD, "[[1,0.1,0,0],[0,1,0,0],[0,0,1,0]]"), "is no rotation and translation");
    check_refused(ONE(GOOD, "[[-1,0,0,0],[0,1,0,0],[0,0,1,0]]"), "right-handed");
    check_refused(ONE(GOOD, "[[1,0,0,1e300],[0,1,0,0],[0,0,1,0]]"),
                  "is no rotation and translation");
    check_refused("{\"frames\":[]}", "\"frames\": is empty");
    check_refused("{}", "\"frames\": is missing");
    check_refused("[]", "is an array; give an object");
    check_refused("{\"frames\":[{\"transform_matrix\":" POSE "}]}",
                  "\"frames[0].file_path\": is missing");
    CHECK(!load("nowhere.json"));
    CHECK_CONTAINS(igi_context_message(ctx), FOLDER "/nowhere.json: no such file");
    finish();
}

/* ---- COLMAP ---- */

/* A camera at (1,2,3) that looks along world +x with world +z up: its axes right, down, forward are
 * the world's -y, -z, +x, so the rotation to the camera has these rows. */
#define QUATERNION 0.5, 0.5, -0.5, 0.5
#define TRANSLATION 2, 3, -1 /* -R (1,2,3) */

static void check_colmap_pose(const igi_camera *camera)
{
    double x, y;
    igi_camera pinhole = *camera;
    const igi_camera *c = &pinhole;
    pinhole.k1 = pinhole.k2 = pinhole.k3 = pinhole.p1 = pinhole.p2 = 0;
    CHECK_NEAR((double)igi_camera_centre(c).x, 1, 1e-6);
    CHECK_NEAR((double)igi_camera_centre(c).y, 2, 1e-6);
    CHECK_NEAR((double)igi_camera_centre(c).z, 3, 1e-6);
    CHECK(igi_camera_project(c, igi_v(11, 2, 3), &x, &y)); /* straight ahead */
    CHECK_NEAR(x, c->cx, 1e-6);
    CHECK_NEAR(y, c->cy, 1e-6);
    CHECK(igi_camera_project(c, igi_v(11, 1, 4), &x, &y)); /* to the right, and up */
    CHECK_NEAR(x, c->cx + c->fl_x / 10, 1e-6);
    CHECK_NEAR(y, c->cy - c->fl_y / 10, 1e-6);
    CHECK(!igi_camera_project(c, igi_v(-9, 2, 3), &x, &y)); /* behind */
}

#define CAMERAS_TXT                                                             \
    "# Camera list\n1 PINHOLE 8 6 5 5.5 4 3\r\n2 SIMPLE_RADIAL 8 6 5 4 3 0.1\n" \
    "7 FULL_OPENCV 8 6 5 5 4 3 1 2 3 4 5 0 0 0\n"
#define POSE_TXT "0.5 0.5 -0.5 0.5 2 3 -1"
#define IMAGES_TXT                                                                          \
    "# Image list\n#\n1 " POSE_TXT " 1 b.png\n1.0 2.0 -1 3 4 5\n2 " POSE_TXT " 2 a.exr\n\n" \
    "3 " POSE_TXT " 7 c d.exr\n"

static void write_colmap(const char *cameras, const char *images)
{
    (void)mkdir(FOLDER "/colmap", 0777);
    write_text("colmap/cameras.txt", cameras);
    write_text("colmap/images.txt", images);
}

static void colmap_text(void)
{
    write_fixture(FOLDER);
    (void)unlink(FOLDER "/colmap/images.bin");
    write_colmap(CAMERAS_TXT, IMAGES_TXT);
    CHECK(load("colmap"));
    CHECK(frame_count == 3);
    if (frame_count == 3) {
        CHECK_STR(frames[0].name, "a");
        CHECK_STR(frames[1].name, "b");
        CHECK_STR(frames[2].name, "c d");
        CHECK_STR(frames[0].path, FOLDER "/colmap/../images/a.exr");
        CHECK_STR(frames[1].path, FOLDER "/colmap/../images/b.exr");   /* beside what COLMAP saw */
        CHECK_STR(frames[2].path, FOLDER "/colmap/../images/c d.exr"); /* not there */
        CHECK(frames[0].camera.k1 == .1 && frames[0].camera.fl_y == 5);
        CHECK(frames[1].camera.fl_y == 5.5 && frames[1].camera.width == 8);
        const igi_camera *full = &frames[2].camera;
        CHECK(full->k1 == 1 && full->k2 == 2 && full->p1 == 3 && full->p2 == 4 && full->k3 == 5);
        for (int i = 0; i < 3; i++) check_colmap_pose(&frames[i].camera);
    }
    finish();
}

static void bad_colmap_text(void)
{
    static const struct {
        const char *cameras, *images, *sentence;
    } cases[] = {
        {"1 FISHEYE 8 6 5\n", IMAGES_TXT, "cameras.txt:1: camera model not known"},
        {"1 PINHOLE 8 6 5 5 4\n", IMAGES_TXT, "cameras.txt:1: fewer parameters"},
        {"1 PINHOLE 8 x\n", IMAGES_TXT, "cameras.txt:1: no width and height"},
        {"1 PINHOLE 0 6 5 5 4 3\n", IMAGES_TXT, "cameras.txt:1: no width and height"},
        {"\nx PINHOLE\n", IMAGES_TXT, "cameras.txt:2: no camera's number"},
        {"1 PINHOLE 8 6 0 5 4 3\n", IMAGES_TXT, "cameras.txt:1: the focal length"},
        {"1 PINHOLE 8 6 nan 5 4 3\n", IMAGES_TXT,
         "cameras.txt:1: an intrinsic number is not finite"},
        {"1 FULL_OPENCV 8 6 5 5 4 3 0 0 0 0 0 1 0 0\n", "", "FULL_OPENCV with k4"},
        {CAMERAS_TXT, "1 " POSE_TXT " 3 b.png\n\n", "images.txt:1: the image names a camera that"},
        {CAMERAS_TXT, "\n1 0 0 0 0 2 3 -1 1 b.png\n", "images.txt:2: the rotation's quaternion"},
        {CAMERAS_TXT, "1 1 0 0 0 inf 3 -1 1 b.png\n", "images.txt:1: the pose is not finite"},
        {CAMERAS_TXT, "1 1 0 0 0 2 3\n", "images.txt:1: not IMAGE_ID QW"},
        {CAMERAS_TXT, "1 " POSE_TXT " 1\n", "images.txt:1: the image has no name"},
        {CAMERAS_TXT, "# none\n", "no image in the model"},
        {"", IMAGES_TXT, "images.txt:3: the image names a camera that"},
    };
    write_fixture(FOLDER);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_colmap(cases[i].cameras, cases[i].images);
        CHECK(!load("colmap"));
        CHECK_CONTAINS(igi_context_message(ctx), cases[i].sentence);
    }
    CHECK(!load("images"));
    CHECK_CONTAINS(igi_context_message(ctx), "images: neither images.bin nor images.txt");
    finish();
}

typedef struct byte_buffer {
    unsigned char bytes[1024];
    size_t size;
} byte_buffer;

static void put(byte_buffer *out, uint64_t value, int count)
{
    for (int i = 0; i < count; i++) out->bytes[out->size++] = (unsigned char)(value >> (8 * i));
}

static void put_double(byte_buffer *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(out, bits, 8);
}

static void make_binary(byte_buffer *cameras, byte_buffer *images)
{
    const double opencv[] = {5, 5.5, 4, 3, .1, .2, .3, .4}, pose[] = {QUATERNION, TRANSLATION};
    *cameras = *images = (byte_buffer){.size = 0};
    put(cameras, 1, 8);
    put(cameras, 4, 4); /* its number */
    put(cameras, 4, 4); /* OPENCV */
    put(cameras, 8, 8);
    put(cameras, 6, 8);
    for (int i = 0; i < 8; i++) put_double(cameras, opencv[i]);
    put(images, 2, 8);
    for (int k = 0; k < 2; k++) {
        put(images, (uint64_t)k + 1, 4);
        for (int i = 0; i < 7; i++) put_double(images, pose[i]);
        put(images, 4, 4);
        put(images, k == 0 ? 'b' : 'a', 1);
        put(images, 0, 1);
        put(images, 1, 8); /* one point */
        for (int i = 0; i < 3; i++) put(images, 0, 8);
    }
}

static void colmap_binary(void)
{
    byte_buffer cameras, images;
    write_fixture(FOLDER);
    make_binary(&cameras, &images);
    (void)mkdir(FOLDER "/model", 0777);
    (void)mkdir(FOLDER "/model/sparse", 0777);
    (void)mkdir(FOLDER "/model/sparse/0", 0777);
    write_bytes("model/sparse/0/cameras.bin", cameras.bytes, cameras.size);
    write_bytes("model/sparse/0/images.bin", images.bytes, images.size);
    CHECK(load("model"));
    CHECK(frame_count == 2);
    if (frame_count == 2) {
        const igi_camera *c = &frames[0].camera;
        CHECK_STR(frames[0].name, "a");
        CHECK_STR(frames[0].path, FOLDER "/model/sparse/0/../../../images/a.exr");
        CHECK(c->k1 == .1 && c->k2 == .2 && c->p1 == .3 && c->p2 == .4 && c->fl_y == 5.5);
        check_colmap_pose(c);
    }
    int refused = 0, shorter = (int)images.size;
    for (size_t size = 0; size < images.size; size++) { /* wherever it is cut off */
        write_bytes("model/sparse/0/images.bin", images.bytes, size);
        refused += !load("model");
        CHECK_CONTAINS(igi_context_message(ctx), "images.bin: byte ");
    }
    CHECK(refused == shorter);
    cameras.bytes[12] = 5; /* OPENCV_FISHEYE */
    write_bytes("model/sparse/0/cameras.bin", cameras.bytes, cameras.size);
    CHECK(!load("model"));
    CHECK_CONTAINS(igi_context_message(ctx), "cameras.bin: byte 32: camera model not known");
    finish();
}

static void scene_with_colmap(void)
{
    write_fixture(FOLDER);
    (void)unlink(FOLDER "/colmap/images.bin");
    write_colmap(CAMERAS_TXT, "1 " POSE_TXT " 1 b.png\n\n2 " POSE_TXT " 2 a.exr\n\n");
    write_text("scene.json", "{\"igi\":1,\"mesh\":\"scene.obj\",\"cameras\":\"colmap\"}");
    CHECK_LOADS();
}

/* ---- rays ---- */

/* Image points of a distorted camera as OpenCV's projectPoints has them (its axes: y down, z
 * forward), and the rays through them back again. */
static void distortion(void)
{
    static const double seen[4][5] = {{.3, -.2, 1, 497.32877672, 132.242894514},
                                      {-.8, .55, 2, 140.874033813, 374.436076339},
                                      {0, 0, 1, 342.3, 235.6},
                                      {.5, .4, 1, 583.928986937, 429.560423955}};
    const igi_camera c = {.width = 640,
                          .height = 480,
                          .fl_x = 535.9,
                          .fl_y = 536.5,
                          .cx = 342.3,
                          .cy = 235.6,
                          .k1 = -.266,
                          .k2 = -.0386,
                          .k3 = .238,
                          .p1 = .00178,
                          .p2 = -.00028,
                          .camera_to_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (int i = 0; i < 4; i++) {
        double x, y;
        igi_vec point = igi_v((float)seen[i][0], (float)-seen[i][1], (float)-seen[i][2]);
        CHECK(igi_camera_project(&c, point, &x, &y));
        CHECK_NEAR(x, seen[i][3], 1e-4); /* the point is of floats */
        CHECK_NEAR(y, seen[i][4], 1e-4);
        igi_vec way = igi_camera_direction(&c, seen[i][3], seen[i][4]);
        CHECK_NEAR((double)igi_length(way), 1, 1e-6);
        CHECK_NEAR((double)igi_length(igi_cross(way, igi_normalize(point))), 0, 1e-6);
        CHECK(igi_dot(way, point) > 0);
    }
}

/* ---- the photographs ---- */

static void missing_images(void)
{
    char text[4000], *at = text;
    write_fixture(FOLDER);
    (void)unlink(FOLDER "/images/b.exr");
    CHECK_REFUSED(IGI_E_DATA, FOLDER "/transforms.json: 1 of 2 images cannot be opened: " FOLDER
                                     "/images/b; put them there, or remove their frames");
    at += sprintf(at, "{\"w\":8,\"h\":6,\"fl_x\":5,\"frames\":[");
    for (int i = 0; i < 20; i++)
        at += sprintf(at, "%s{\"file_path\":\"images/%c.exr\",\"transform_matrix\":" POSE "}",
                      i ? "," : "", 'a' + i);
    sprintf(at, "]}");
    write_text("transforms.json", text);
    CHECK_REFUSED(IGI_E_DATA, "19 of 20 images cannot be opened: " FOLDER "/images/b.exr, " FOLDER
                              "/images/c.exr, " FOLDER "/images/d.exr, ...; put them there");
}

static void images_that_do_not_fit(void)
{
    write_fixture(FOLDER);
    write_image("images/b.exr", 8, 7, 3);
    CHECK_REFUSED(IGI_E_DATA, FOLDER "/images/b.exr: is 8x7 pixels, but its camera 8x6; give");
    write_image("images/b.exr", 8, 6, 5);
    CHECK_REFUSED(IGI_E_DATA,
                  FOLDER "/images/b.exr: has 5 bands, but " FOLDER "/images/a.exr has 3");
    write_image("images/b.exr", 8, 6, 4); /* alpha is no band */
    CHECK_LOADS();
    write_text("images/b.exr", "v/1\x01");
    CHECK_REFUSED(IGI_E_DATA, FOLDER "/images/b.exr: ");
    (void)unlink(FOLDER "/images/b.exr");
    (void)mkdir(FOLDER "/images/b.exr", 0777);
    CHECK_REFUSED(IGI_E_DATA, "1 of 2 images cannot be opened");
    (void)rmdir(FOLDER "/images/b.exr");
}

/* Wherever its header is cut off, an image is refused by name. */
static void truncated_header(void)
{
    char bytes[600];
    write_fixture(FOLDER);
    FILE *file = fopen(FOLDER "/images/a.exr", "rb");
    size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    if (file) fclose(file);
    CHECK(size > 250);
    for (size_t cut = 0; cut < 250; cut += 7) {
        write_bytes("images/b.exr", bytes, cut);
        CHECK_REFUSED(IGI_E_DATA, FOLDER "/images/b.exr: ");
    }
}

static void doubled_frame(void)
{
    write_fixture(FOLDER);
    write_text("transforms.json",
               "{\"w\":8,\"h\":6,\"fl_x\":5,\"frames\":["
               "{\"file_path\":\"images/a\",\"transform_matrix\":" POSE "},"
               "{\"file_path\":\"images/a.exr\",\"transform_matrix\":" POSE "}]}");
    CHECK_REFUSED(IGI_E_DATA, "two frames name " FOLDER "/images/a.exr; remove one");
}

static void one_image_of_many_bands(void)
{
    write_fixture(FOLDER);
    write_image("images/a.exr", 8, 6, 16);
    write_text("transforms.json", "{\"w\":8,\"h\":6,\"fl_x\":5,\"frames\":["
                                  "{\"file_path\":\"images/a\",\"transform_matrix\":" POSE "}]}");
    write_scene("{\"type\":\"ambient\",\"radiance\":[1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16]}", "");
    CHECK_LOADS();
    write_scene(BOX_LIGHT, "");
    CHECK_REFUSED(IGI_E_DATA, "\"lights[0].radiance\": has 3 bands, but the images have 16");
}

TEST_MAIN({"all keys", all_keys}, {"intrinsics by default", intrinsics_by_default},
          {"bad transforms", bad_transforms}, {"COLMAP text", colmap_text},
          {"bad COLMAP text", bad_colmap_text}, {"COLMAP binary", colmap_binary},
          {"scene with COLMAP", scene_with_colmap}, {"distortion", distortion},
          {"missing images", missing_images}, {"images that do not fit", images_that_do_not_fit},
          {"truncated header", truncated_header}, {"doubled frame", doubled_frame},
          {"one image of many bands", one_image_of_many_bands})
