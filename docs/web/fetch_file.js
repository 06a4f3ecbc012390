// Fetches a file of the site.

/// Returns the response with a file. Throws an Error that names the address if there is none.
export async function fetchFile(address) {
  const response = await fetch(address).catch(error => { throw new Error(`${address}: ${error.message}`); });
  if (!response.ok) throw new Error(`${address}: ${response.status} ${response.statusText}`);
  return response;
}
