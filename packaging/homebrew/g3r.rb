class G3r < Formula
  desc "Outward normals and watertight meshes from unoriented point clouds"
  homepage "https://g3r.example.org"
  url "https://g3r.example.org/g3r-0.2.0.tar.gz"
  license "MIT"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "eigen" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "pkgconf" => :build
  depends_on "highway"
  depends_on "libpng"
  depends_on :linux # the shared library is linked with a version script
  depends_on "tbb"

  uses_from_macos "zlib"

  def install
    args = %w[-DG3R_BUILD_TESTS=OFF -DG3R_BUILD_BENCH=OFF -DG3R_BUILD_EXAMPLES=OFF]
    system "cmake", "-S", ".", "-B", "build/brew", "-G", "Ninja", *args, *std_cmake_args
    system "cmake", "--build", "build/brew"
    system "cmake", "--install", "build/brew"
  end

  test do
    (testpath/"corners.xyz").write [0, 1].product([0, 1], [0, 1]).map { |p| p.join(" ") }.join("\n")
    system bin/"g3r", "orient", "corners.xyz", "oriented.ply"
    assert_path_exists testpath/"oriented.ply"
  end
end
