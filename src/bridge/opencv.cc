/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenCV's boards and lenses behind C.
 */
#include "bridge/guarded.hh"
#include "bridge/opencv.h"

#ifdef IGI_ARUCO
#include <opencv2/aruco/charuco.hpp>
#endif
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstring>
#include <vector>

namespace
{

// The refinement looks at a square around each corner. One that reaches the next corner drags the
// corners by a pixel and makes a good photograph look bad, so it follows the smallest distance.
int window_of(const std::vector<cv::Point2f> &corners, int columns)
{
    double least = 1e9;
    for (size_t i = 0; i < corners.size(); i++)
        for (size_t step : {size_t(1), size_t(columns)}) {
            const bool same_row = i / size_t(columns) == (i + step) / size_t(columns);
            if (i + step < corners.size() && (step > 1 || same_row))
                least = std::min(least, cv::norm(corners[i + step] - corners[i]));
        }
    return std::max(2, std::min(11, int(.4 * least)));
}

} // namespace

igi_status igi_cv_find_chessboard(igi_context *ctx, const uint8_t *grey, int width, int height,
                                  int columns, int rows, float *corners, bool *found)
{
    *found = false;
    return igi::guarded(ctx, "chessboard", [&] {
        const cv::Mat image(height, width, CV_8UC1, const_cast<uint8_t *>(grey));
        std::vector<cv::Point2f> points;
        if (!cv::findChessboardCorners(image, cv::Size(columns, rows), points,
                                       cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
            return;
        const int half = window_of(points, columns);
        cv::cornerSubPix(
            image, points, cv::Size(half, half), cv::Size(-1, -1),
            cv::TermCriteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 1e-3));
        for (size_t i = 0; i < points.size(); i++) {
            corners[2 * i] = points[i].x;
            corners[2 * i + 1] = points[i].y;
        }
        *found = true;
    });
}

#ifdef IGI_ARUCO
namespace
{

// NULL: no such dictionary, or it has too few markers for the board.
cv::Ptr<cv::aruco::CharucoBoard> board_of(const igi_cv_charuco *wanted)
{
    static const char *const names[] = {
        "4X4_50", "4X4_100", "4X4_250", "4X4_1000", "5X5_50", "5X5_100", "5X5_250", "5X5_1000",
        "6X6_50", "6X6_100", "6X6_250", "6X6_1000", "7X7_50", "7X7_100", "7X7_250", "7X7_1000"};
    const int columns = wanted->columns + 1, rows = wanted->rows + 1;
    for (int i = 0; i < 16; i++) {
        if (std::strcmp(wanted->dictionary, names[i]) != 0) continue;
        const auto dictionary = cv::aruco::getPredefinedDictionary(i);
        if (columns * rows / 2 > dictionary->bytesList.rows) break;
        return cv::aruco::CharucoBoard::create(columns, rows, 1, float(wanted->marker_share),
                                               dictionary);
    }
    return {};
}

igi_status refuse_dictionary(igi_context *ctx, const igi_cv_charuco *board)
{
    return igi_fail(ctx, IGI_E_USAGE,
                    "ChArUco: no markers %.20s, or too few of them for %d x %d inner corners; name "
                    "those of the board: 4X4_50 ... 5X5_100 ... 7X7_1000",
                    board->dictionary, board->columns, board->rows);
}

} // namespace

igi_status igi_cv_find_charuco(igi_context *ctx, const uint8_t *grey, int width, int height,
                               const igi_cv_charuco *wanted, float *corners, size_t *found)
{
    bool known = false;
    *found = 0;
    const igi_status status = igi::guarded(ctx, "ChArUco", [&] {
        const auto board = board_of(wanted);
        if (!board) return;
        known = true;
        const cv::Mat image(height, width, CV_8UC1, const_cast<uint8_t *>(grey));
        std::vector<std::vector<cv::Point2f>> markers;
        std::vector<int> ids, corner_ids;
        std::vector<cv::Point2f> points;
        std::fill_n(corners, size_t(wanted->columns) * size_t(wanted->rows) * 2, std::nanf(""));
        cv::aruco::detectMarkers(image, board->dictionary, markers, ids);
        if (ids.empty()) return;
        cv::aruco::interpolateCornersCharuco(markers, ids, image, board, points, corner_ids);
        for (size_t i = 0; i < points.size(); i++) {
            corners[2 * corner_ids[i]] = points[i].x;
            corners[2 * corner_ids[i] + 1] = points[i].y;
        }
        *found = points.size();
    });
    return status == IGI_OK && !known ? refuse_dictionary(ctx, wanted) : status;
}

igi_status igi_cv_draw_charuco(igi_context *ctx, const igi_cv_charuco *wanted, int side,
                               uint8_t *grey)
{
    bool known = false;
    const igi_status status = igi::guarded(ctx, "ChArUco", [&] {
        const auto board = board_of(wanted);
        if (!board) return;
        known = true;
        cv::Mat picture((wanted->rows + 1) * side, (wanted->columns + 1) * side, CV_8UC1, grey);
        board->draw(picture.size(), picture);
    });
    return status == IGI_OK && !known ? refuse_dictionary(ctx, wanted) : status;
}
#else
namespace
{

igi_status refuse_boards(igi_context *ctx)
{
    return igi_fail(
        ctx, IGI_E_USAGE,
        "ChArUco: this igi was built without such boards; install libopencv-contrib-dev "
        "and build it again, or use a plain chessboard");
}

} // namespace

igi_status igi_cv_find_charuco(igi_context *ctx, const uint8_t *, int, int, const igi_cv_charuco *,
                               float *, size_t *found)
{
    *found = 0;
    return refuse_boards(ctx);
}

igi_status igi_cv_draw_charuco(igi_context *ctx, const igi_cv_charuco *, int, uint8_t *)
{
    return refuse_boards(ctx);
}
#endif

namespace
{

// The corners of a view that were seen, on the board and in the photograph; which of them they are.
std::vector<size_t> seen_corners(const igi_cv_views *views, size_t view,
                                 std::vector<cv::Point3f> &board, std::vector<cv::Point2f> &corners)
{
    std::vector<size_t> which;
    const float *from = views->corners + view * views->points * 2;
    for (size_t p = 0; p < views->points; p++) {
        if (std::isnan(from[2 * p])) continue;
        const float *at = views->board + 3 * p;
        board.emplace_back(at[0], at[1], at[2]);
        corners.emplace_back(from[2 * p], from[2 * p + 1]);
        which.push_back(p);
    }
    return which;
}

} // namespace

igi_status igi_cv_calibrate(igi_context *ctx, const igi_cv_views *views,
                            double parameters[IGI_CV_PARAMETERS],
                            double deviations[IGI_CV_PARAMETERS], double *rms, double *view_rms)
{
    return igi::guarded(ctx, "calibration", [&] {
        std::vector<std::vector<cv::Point3f>> boards(views->count);
        std::vector<std::vector<cv::Point2f>> corners(views->count);
        for (size_t v = 0; v < views->count; v++) seen_corners(views, v, boards[v], corners[v]);
        cv::Mat camera, distortion, intrinsic_deviations, extrinsic_deviations, errors;
        std::vector<cv::Mat> rotations, translations;
        *rms = cv::calibrateCamera(boards, corners, cv::Size(views->width, views->height), camera,
                                   distortion, rotations, translations, intrinsic_deviations,
                                   extrinsic_deviations, errors);
        const double fitted[IGI_CV_PARAMETERS] = {
            camera.at<double>(0, 0),  camera.at<double>(1, 1),  camera.at<double>(0, 2),
            camera.at<double>(1, 2),  distortion.at<double>(0), distortion.at<double>(1),
            distortion.at<double>(2), distortion.at<double>(3), distortion.at<double>(4)};
        for (int i = 0; i < IGI_CV_PARAMETERS; i++) {
            parameters[i] = fitted[i];
            deviations[i] = intrinsic_deviations.at<double>(i);
        }
        for (size_t v = 0; v < views->count; v++) view_rms[v] = errors.at<double>(int(v));
    });
}

igi_status igi_cv_residuals(igi_context *ctx, const igi_cv_views *views,
                            const double parameters[IGI_CV_PARAMETERS], float *residuals)
{
    const size_t size = views->count * views->points * 2;
    std::fill_n(residuals, size, std::nanf(""));
    return igi::guarded(ctx, "residuals", [&] {
        const cv::Matx33d camera(parameters[0], 0, parameters[2], 0, parameters[1], parameters[3],
                                 0, 0, 1);
        const cv::Mat distortion(1, 5, CV_64F, const_cast<double *>(parameters + 4));
        for (size_t v = 0; v < views->count; v++) {
            std::vector<cv::Point3f> board;
            std::vector<cv::Point2f> corners, expected;
            cv::Mat rotation, translation;
            const std::vector<size_t> which = seen_corners(views, v, board, corners);
            cv::solvePnP(board, corners, camera, distortion, rotation, translation);
            cv::projectPoints(board, rotation, translation, camera, distortion, expected);
            for (size_t i = 0; i < which.size(); i++) {
                float *to = residuals + (v * views->points + which[i]) * 2;
                to[0] = corners[i].x - expected[i].x;
                to[1] = corners[i].y - expected[i].y;
            }
        }
    });
}

igi_status igi_cv_load_lens(igi_context *ctx, const char *path, int size[2],
                            double parameters[IGI_CV_PARAMETERS])
{
    bool good = false;
    const igi_status status = igi::guarded(ctx, path, [&] {
        cv::FileStorage file(path, cv::FileStorage::READ);
        cv::Mat matrix, distortion, m, d;
        if (!file.isOpened()) return;
        file["camera_matrix"] >> matrix;
        file["distortion_coefficients"] >> distortion;
        size[0] = file["image_width"].empty() ? 0 : int(file["image_width"]);
        size[1] = file["image_height"].empty() ? 0 : int(file["image_height"]);
        if (matrix.rows != 3 || matrix.cols != 3 || matrix.channels() != 1) return;
        if (distortion.channels() != 1 || distortion.total() > 5) return;
        matrix.convertTo(m, CV_64F);
        distortion.convertTo(d, CV_64F);
        const double values[4] = {m.at<double>(0, 0), m.at<double>(1, 1), m.at<double>(0, 2),
                                  m.at<double>(1, 2)};
        std::memcpy(parameters, values, sizeof values);
        for (size_t i = 0; i < 5; i++) parameters[4 + i] = i < d.total() ? d.at<double>(int(i)) : 0;
        good = true;
    });
    if (good || (status != IGI_OK && status != IGI_E_NO_ANSWER)) return status;
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: no lens of OpenCV's in it: image_width, image_height, camera_matrix (3 x "
                    "3) and up to five distortion_coefficients are needed",
                    path);
}
