// Fetches files of the site.

/// Returns the bytes of a file. Throws an Error that names the address if they do not come.
export async function fetchBytes(address) {
  try {
    const response = await fetch(address);
    if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
    return new Uint8Array(await response.arrayBuffer());
  } catch (error) {
    throw new Error(`${address}: ${error.message}`);
  }
}

/// Returns the text of a file in UTF-8, likewise.
export async function fetchText(address) { return new TextDecoder().decode(await fetchBytes(address)); }
