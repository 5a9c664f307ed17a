// The mollified kernels as polynomials in w = kMapScale s / (s + kMapPole) - 1, s = (rho / e)^2: docs/math.md, "Mollified kernels by
// polynomials". Fitted by Lawson iteration for the least relative error over [0, kMollifierReach]: 6e-8 (float), 1e-15 (double),
// 1.3e-4 (float, rough) before rounding; coefficients rounded to float leave 6e-7 of g and 2e-6 of b (fast_sum_test).
#pragma once

#include "kernels/kernels.h"

namespace g3r {

constexpr double kMapPole = 30;  // c of w(s); 20..40 give about the same degree
template <class T>
constexpr double kReachSquared = kMollifierReach<T>* kMollifierReach<T>;
template <class T>
constexpr double kMapScale = 2 * (kReachSquared<T> + kMapPole) / kReachSquared<T>;  // w = 1 at the reach
/// Relative error of the kernels: rounding; or kRoughPolynomialError, float only.
enum class Precision { kFull, kRough };
inline constexpr double kRoughPolynomialError = 1.3e-4;
template <class T, Precision>
struct Polynomials;
template <>
struct Polynomials<float, Precision::kFull> {
  static constexpr int kDegree = 10;
  static constexpr float kSingleLayer[kDegree + 1] = {3.356490651e-01F,  -2.109202984e-01F, 1.247985877e-01F, -7.579804802e-02F,
                                                      3.640737097e-02F,  -1.235096975e-02F, 2.213220652e-03F, 1.248106875e-04F,
                                                      -1.325545821e-04F, 2.168155549e-06F,  6.532988285e-06F};  // NOLINT
  static constexpr float kDoubleLayer[kDegree + 1] = {3.694301031e-02F,  -6.544850826e-02F, 6.874023178e-02F, -5.271739658e-02F,
                                                      2.926637687e-02F,  -1.089574491e-02F, 2.149868879e-03F, 7.662828656e-05F,
                                                      -1.247450271e-04F, 4.201369121e-06F,  5.953868674e-06F};  // NOLINT
  static constexpr float kStokeslet[kDegree + 1] = {2.547960387e-02F,  -3.462541109e-02F, 2.588339531e-02F, -1.383588128e-02F,
                                                    5.266386861e-03F,  -1.248453111e-03F, 9.028036458e-05F, 3.890562319e-05F,
                                                    -7.762573976e-06F, -1.459254146e-06F, 4.054928515e-07F};  // NOLINT
  static constexpr float kGradient[kDegree + 1] = {1.146340609e-02F,  -3.082309253e-02F, 4.285684538e-02F, -3.888160955e-02F,
                                                   2.400000286e-02F,  -9.646856020e-03F, 2.059324544e-03F, 3.703744792e-05F,
                                                   -1.164463099e-04F, 6.002793598e-06F,  5.251592353e-06F};  // NOLINT
};
template <>
struct Polynomials<float, Precision::kRough> {
  static constexpr int kDegree = 6;
  static constexpr float kSingleLayer[kDegree + 1] = {3.356495015e-01F, -2.109081309e-01F, 1.247781530e-01F, -7.590229464e-02F,
                                                      3.653216159e-02F, -1.213443340e-02F, 1.983917535e-03F};  // NOLINT
  static constexpr float kDoubleLayer[kDegree + 1] = {3.694297296e-02F, -6.544209353e-02F, 6.873089493e-02F, -5.278002403e-02F,
                                                      2.935656107e-02F, -1.075966528e-02F, 1.951396708e-03F};  // NOLINT
  static constexpr float kStokeslet[kDegree + 1] = {2.547918280e-02F, -3.462336711e-02F, 2.589185070e-02F, -1.385958507e-02F,
                                                    5.245499760e-03F, -1.190390083e-03F, 9.668971928e-05F};  // NOLINT
  static constexpr float kGradient[kDegree + 1] = {1.146295533e-02F, -3.081146008e-02F, 4.284231299e-02F, -3.897412776e-02F,
                                                   2.414597246e-02F, -9.512777300e-03F, 1.807112071e-03F};  // NOLINT
};
template <>
struct Polynomials<double, Precision::kFull> {
  static constexpr int kDegree = 24;
  static constexpr double kSingleLayer[kDegree + 1] = {
      2.72238911498497105e-01,  -1.96628995570388543e-01, 1.22041552220679431e-01,  -9.38767211879213276e-02,
      6.36532975560639841e-02,  -3.55124354476142531e-02, 1.33667521248684220e-02,  -1.87221549284269438e-03,
      -1.00447010871894523e-03, 4.33479492326374995e-04,  8.71531243935183509e-05,  -6.43831087415920486e-05,
      -1.52842617681381186e-05, 8.23994650825937019e-06,  3.57644004047402987e-06,  -6.19828048109925261e-07,
      -7.26394739696446179e-07, -9.76273908300941179e-08, 9.14078289285755965e-08,  4.80875567915677717e-08,
      6.73808728264686125e-10,  -8.94533676379756188e-09, -2.86814591679717682e-09, 7.08848637133337684e-10,
      4.17013371150739815e-10};  // NOLINT
  static constexpr double kDoubleLayer[kDegree + 1] = {
      2.01166718020476080e-02,  -4.30581442740953085e-02, 5.53298020606874871e-02,  -5.70005705158219203e-02,
      4.74088379271178084e-02,  -2.98020127366235635e-02, 1.23890055148868014e-02,  -2.04151894739308323e-03,
      -8.67331441306248212e-04, 4.35830834632103237e-04,  7.19619343207371088e-05,  -6.43977927655205748e-05,
      -1.31880004148318429e-05, 8.52117086637677447e-06,  3.34405364235570986e-06,  -6.99147573483444155e-07,
      -7.11172127133926147e-07, -8.23308928412389936e-08, 9.75936165374723459e-08,  4.85394875779976892e-08,
      -2.72723543696958550e-09, -9.90776908408788320e-09, -1.68788690034080203e-09, 9.21469765054919531e-10,
      2.23793630707046198e-10};  // NOLINT
  static constexpr double kStokeslet[kDegree + 1] = {
      1.57114895741949818e-02,  -2.77761856613164514e-02, 2.67659526632657123e-02,  -1.95822323957149901e-02,
      1.11852221262368698e-02,  -4.56992260514550372e-03, 1.00868766793197912e-03,  9.99641456844417445e-05,
      -1.23252977843750109e-04, 5.19438880044147083e-06,  1.43938911623116771e-05,  -5.51493723960467629e-07,
      -1.94187723378307295e-06, -1.52190991875949153e-07, 2.51121473510972186e-07,  7.40059988413645635e-08,
      -1.93436612501158679e-08, -1.68810633366780844e-08, -2.42648522998569806e-09, 2.11953706989512661e-09,
      1.28229726827448888e-09,  -4.63661094553928932e-11, -2.51441230517015657e-10, -1.90924654212535143e-11,
      2.37574674697121477e-11};  // NOLINT
  static constexpr double kGradient[kDegree + 1] = {
      4.40518222785261232e-03,  -1.52819586127788849e-02, 2.85638493974249529e-02,  -3.74183381201090223e-02,
      3.62236158007392187e-02,  -2.52320901312769429e-02, 1.13803178493715879e-02,  -2.14148309744039214e-03,
      -7.44078483866628527e-04, 4.30636489075930282e-04,  5.75681377737844482e-05,  -6.38465355455712126e-05,
      -1.12463705508543696e-05, 8.67414049790631883e-06,  3.09326561140328803e-06,  -7.74760016771132008e-07,
      -6.91919385251266299e-07, -6.33591945183250508e-08, 9.96345696869174391e-08,  4.47540418210992417e-08,
      -3.42699442045166689e-09, -9.11945890867278143e-09, -1.78370930853171891e-09, 7.99120106011687983e-10,
      2.78650931919291843e-10};  // NOLINT
};

}  // namespace g3r
