// Small dense algebra for the metric explorer: matrices are arrays of rows. Positive definite
// matrices of 22 × 22 only, so the plainest Cholesky factorisation is fast and accurate enough.

/** Graph Laplacian of a skeleton given by the parent of every joint (ProjFlow eq. 11). */
function laplacian(parents) {
  const L = parents.map(() => parents.map(() => 0));
  parents.forEach((parent, joint) => {
    if (parent < 0) return;
    L[joint][joint] += 1;
    L[parent][parent] += 1;
    L[joint][parent] -= 1;
    L[parent][joint] -= 1;
  });
  return L;
}

/** R_J = w L + λ I (ProjFlow eq. 50). */
function jointMetric(L, w, ridge) {
  return L.map((row, i) => row.map((value, j) => w * value + (i === j ? ridge : 0)));
}

/** The lower triangle G with G Gᵀ = R; an error if R is not positive definite. */
function cholesky(R) {
  const G = R.map((row) => row.map(() => 0));
  for (let i = 0; i < R.length; i++) {
    for (let j = 0; j <= i; j++) {
      let rest = R[i][j];
      for (let k = 0; k < j; k++) rest -= G[i][k] * G[j][k];
      if (i === j && !(rest > 0)) throw new Error("the metric is not positive definite");
      G[i][j] = i === j ? Math.sqrt(rest) : rest / G[j][j];
    }
  }
  return G;
}

/** The solution x of G Gᵀ x = b: forwards with G, then backwards with its transpose. */
function solveCholesky(G, b) {
  const x = [...b];
  const n = x.length;
  for (let i = 0; i < n; i++) {
    for (let k = 0; k < i; k++) x[i] -= G[i][k] * x[k];
    x[i] /= G[i][i];
  }
  for (let i = n - 1; i >= 0; i--) {
    for (let k = i + 1; k < n; k++) x[i] -= G[k][i] * x[k];
    x[i] /= G[i][i];
  }
  return x;
}

/** R⁻¹, column by column; it is symmetric, so its columns are its rows. */
function inverse(R) {
  const G = cholesky(R);
  return R.map((_, column) => solveCholesky(G, R.map((_, row) => (row === column ? 1 : 0))));
}

/** How far each joint moves when one is pulled by 1: eq. 7 for a single hard pin. */
function sharesOf(R, pulled) {
  const column = inverse(R)[pulled];
  return column.map((value) => value / column[pulled]);
}
